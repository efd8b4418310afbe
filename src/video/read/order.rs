//! Which frames are missing: packets sent to the decoder against the frames that came out of it.
//!
//! Frames come out in the order of presentation. When one comes out, every packet of an earlier presentation time that
//! has not come out never will: its frame is missing. A packet that the decoder can't make sense of damages what is
//! predicted from it, which can be every frame decoded after it up to the next key frame, and those that follow this
//! key frame in the file but are shown before it. Only what is under way is kept, so memory does not grow with the
//! video.

use std::collections::BTreeMap;

/// A packet sent.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::video) struct Sent {
    /// Its number in the file's (the decoder's) order.
    pub(in crate::video) number: u64,
    /// The number of key frames up to it, itself included.
    pub(in crate::video) group: u64,
    /// Shown before its group's key frame: it may be predicted from the group before.
    pub(in crate::video) leading: bool,
    /// Sent before the first key frame, where it counts only if a sound frame comes of it; or shown before it, where it
    /// never counts.
    pub(in crate::video) prelude: bool,
}

/// Groups after which a damage is forgotten; none of its frames can still be under way.
const GROUPS_KEPT: u64 = 512;
/// Packets under way at most; no decoder holds back so many.
const UNDER_WAY: usize = 512;
/// Without presentation times, a packet is given up after so many later ones have come out.
const GIVEN_UP_AFTER: i64 = 64;

/// What is under way.
#[derive(Debug, Default)]
pub(in crate::video) struct Order {
    under_way: BTreeMap<i64, Sent>,
    /// The first damaged packet of each damaged group.
    damaged: BTreeMap<u64, u64>,
    /// Only frames known to be damaged are missing: not every packet makes a frame (fields, hidden frames).
    pub(in crate::video) only_damaged: bool,
    /// The keys are the file's order and not the presentation's.
    pub(in crate::video) keys_are_numbers: bool,
}

impl Order {
    /// A packet to be shown at `key` goes to the decoder. Gives packets that never came out and are too many to keep.
    pub(in crate::video) fn sent(&mut self, key: i64, sent: Sent) -> Option<(i64, Sent)> {
        self.under_way.insert(key, sent);
        if self.under_way.len() > UNDER_WAY { self.under_way.pop_first() } else { None }
    }

    pub(in crate::video) fn damage(&mut self, number: u64, group: u64) {
        let first = self.damaged.entry(group).or_insert(number);
        *first = number.min(*first);
        self.damaged = self.damaged.split_off(&group.saturating_sub(GROUPS_KEPT));
    }

    /// Whether a frame may show a damage.
    pub(in crate::video) fn is_damaged(&self, sent: &Sent) -> bool {
        self.damaged.get(&sent.group).is_some_and(|&first| sent.number >= first)
            || sent.leading && self.damaged.contains_key(&sent.group.wrapping_sub(1))
    }

    /// A packet sent before `number` has not come out yet: it may turn out to be damaged.
    pub(in crate::video) fn awaits_before(&self, number: u64) -> bool {
        self.under_way.values().any(|sent| sent.number < number)
    }

    /// A frame came out. Gives the missing ones before it, in order, and its packet; none when nobody waits for it.
    pub(in crate::video) fn came_out(&mut self, key: i64) -> (Vec<(i64, Sent)>, Option<Sent>) {
        let Some(sent) = self.under_way.remove(&key) else { return (Vec::new(), None) };
        let later = self.under_way.split_off(&key);
        let earlier = std::mem::replace(&mut self.under_way, later);
        let mut missing = Vec::new();
        for (at, other) in earlier {
            let damaged = self.is_damaged(&other);
            if self.keys_are_numbers && !damaged && at + GIVEN_UP_AFTER > key {
                self.under_way.insert(at, other);
            } else if !other.prelude && (damaged || !self.only_damaged) {
                missing.push((at, other));
            }
        }
        (missing, Some(sent))
    }

    /// The decoder has nothing left: all that has not come out is missing.
    pub(in crate::video) fn end(&mut self) -> Vec<(i64, Sent)> {
        let left = std::mem::take(&mut self.under_way);
        left.into_iter().filter(|(_, sent)| !sent.prelude && (!self.only_damaged || self.is_damaged(sent))).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn packet(number: u64, group: u64) -> Sent {
        Sent { number, group, leading: false, prelude: false }
    }

    #[test]
    fn what_was_passed_over_is_missing_in_order() {
        let mut order = Order::default();
        for (number, key) in [(0, 0), (1, 30), (2, 10), (3, 20), (4, 40)] {
            assert!(order.sent(key, packet(number, 1)).is_none());
        }
        assert_eq!(order.came_out(0), (vec![], Some(packet(0, 1))));
        assert_eq!(order.came_out(30), (vec![(10, packet(2, 1)), (20, packet(3, 1))], Some(packet(1, 1))));
        assert_eq!(order.came_out(20), (vec![], None));
        assert_eq!(order.end(), vec![(40, packet(4, 1))]);
        assert_eq!(order.end(), vec![]);
    }

    #[test]
    fn damage_reaches_to_the_next_key_frame_and_its_leading_frames() {
        let mut order = Order::default();
        order.damage(5, 2);
        order.damage(7, 2);
        assert!(!order.is_damaged(&packet(4, 2)));
        assert!(order.is_damaged(&packet(5, 2)));
        assert!(order.is_damaged(&packet(9, 2)));
        assert!(!order.is_damaged(&packet(10, 3)));
        assert!(order.is_damaged(&Sent { leading: true, ..packet(11, 3) }));
        assert!(!order.is_damaged(&Sent { leading: true, ..packet(21, 4) }));
        assert!(!order.is_damaged(&packet(1, 1)));
    }

    #[test]
    fn before_the_first_key_frame_nothing_is_missing() {
        let mut order = Order::default();
        let before = Sent { number: 0, group: 0, leading: false, prelude: true };
        order.sent(-10, before);
        order.sent(0, packet(1, 1));
        assert_eq!(order.came_out(0), (vec![], Some(packet(1, 1))));
    }

    #[test]
    fn only_damaged_ones_are_missing_where_packets_need_not_make_frames() {
        let mut order = Order { only_damaged: true, ..Order::default() };
        order.sent(0, packet(0, 1));
        order.sent(1, packet(1, 1));
        order.sent(2, packet(2, 2));
        assert_eq!(order.came_out(1).0, vec![]);
        order.damage(2, 2);
        assert_eq!(order.end(), vec![(2, packet(2, 2))]);
    }

    #[test]
    fn memory_is_bounded() {
        let mut order = Order { keys_are_numbers: true, only_damaged: true, ..Order::default() };
        for number in 0..5000u64 {
            order.sent(number as i64, packet(number, number / 3));
            order.damage(number, number / 3);
            if number % 2 == 0 {
                order.came_out(number as i64);
            }
        }
        assert!(order.under_way.len() <= UNDER_WAY && order.damaged.len() <= GROUPS_KEPT as usize + 1);
    }
}
