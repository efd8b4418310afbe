//! Which marker follows which along the finger, as the marker file's segments and joints say.
//!
//! A layout may branch: thumb and index finger from one mark at the wrist, or fingers that share nothing. Each branch
//! is a
//! finger by itself; nothing but colours and `[start]` says which finger is which.

use crate::posture::layout::Layout;

/// A marker in the chain.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Link {
    pub(crate) marker: usize,
    /// The place in the chain of the marker before it on the way from proximal to distal.
    pub(crate) before: Option<usize>,
    /// Both are on one segment (if not, a joint lies between them).
    pub(crate) rigid: bool,
    /// Which way the joint before this segment bends is known: on a branching layout a thumb may bend either way.
    pub(crate) bends: bool,
}

/// Markers such that each comes after the one before it.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Chain {
    pub(crate) links: Vec<Link>,
}

fn place(links: &[Link], marker: usize) -> Option<usize> {
    links.iter().position(|link| link.marker == marker)
}

impl Chain {
    /// The chain of a layout: the needed markers, and those that have a colour in common with another one, for they
    /// help to tell which is which.
    ///
    /// A segment follows the one that a joint hangs it on. A segment in no joint is taken to follow, and to be followed
    /// by, its neighbours in the file.
    pub(crate) fn new(layout: &Layout) -> Self {
        let needed = layout.needed();
        let shared = |marker: usize| {
            let colour = layout.markers[marker].colour;
            layout.markers.iter().filter(|other| other.colour == colour).count() > 1
        };
        let wanted: Vec<bool> = (0..layout.markers.len()).map(|marker| needed[marker] || shared(marker)).collect();
        let count = layout.segments.len();
        let mut parent = layout.hung_on.clone();
        let jointed = |segment: usize| layout.hung_on[segment].is_some() || layout.hung_on.contains(&Some(segment));
        for (segment, parent) in parent.iter_mut().enumerate().skip(1) {
            if parent.is_none() && (!jointed(segment) || !jointed(segment - 1)) {
                *parent = Some(segment - 1);
            }
        }
        let mut links: Vec<Link> = Vec::new();
        let finger_joints: Vec<usize> = layout
            .joints
            .iter()
            .filter(|joint| FINGER_JOINTS.contains(&&*joint.name))
            .map(|joint| joint.segments[1])
            .collect();
        let mut done = vec![false; count];
        while let Some(segment) = next_segment(&parent, &done) {
            done[segment] = true;
            let bends = finger_joints.contains(&segment);
            let [first, second] = layout.segments[segment].markers;
            // The last marker before this segment that is in the chain, further and further towards the hand.
            let mut hung = None;
            let (mut at, mut steps) = (parent[segment], 0);
            while let (Some(before), None) = (at, hung) {
                let [near, far] = layout.segments[before].markers;
                hung = place(&links, far).or_else(|| place(&links, near));
                (at, steps) = (parent[before], steps + 1);
                if steps > count {
                    break;
                }
            }
            if wanted[first] && place(&links, first).is_none() {
                links.push(Link { marker: first, before: hung, rigid: false, bends });
            }
            if wanted[second] && place(&links, second).is_none() {
                let before = place(&links, first);
                links.push(Link { marker: second, before: before.or(hung), rigid: before.is_some(), bends });
            }
        }
        for marker in (0..layout.markers.len()).filter(|&marker| wanted[marker]) {
            if links.iter().all(|link| link.marker != marker) {
                links.push(Link { marker, before: None, rigid: false, bends: false });
            }
        }
        let mut chain = Self { links };
        if !chain.branches() {
            chain.links.iter_mut().for_each(|link| link.bends = true);
        }
        chain
    }

    /// The place of a marker; none of one that is not in the chain.
    pub(crate) fn place_of(&self, marker: usize) -> Option<usize> {
        place(&self.links, marker)
    }

    fn children(&self, place: usize) -> usize {
        self.links.iter().filter(|link| link.before == Some(place)).count()
    }

    /// Whether there is more than one finger: a marker with two after it, or two rows that do not meet.
    fn branches(&self) -> bool {
        let roots =
            (0..self.links.len()).filter(|&place| self.links[place].before.is_none() && self.children(place) > 0);
        roots.count() > 1 || (0..self.links.len()).any(|place| self.children(place) > 1)
    }

    /// The place and those before it, up to the most proximal one.
    fn way(&self, place: usize) -> Vec<usize> {
        std::iter::successors(Some(place), |&at| self.links[at].before).collect()
    }

    /// The places on branches that could be taken for one another: a colour in common, no colour that only one of
    /// them has,
    /// and no place on either that is `fixed`.
    pub(crate) fn undecided(&self, paint_of: &[usize], fixed: &[Option<usize>]) -> Vec<usize> {
        let ways: Vec<Vec<usize>> = (0..self.links.len()).map(|place| self.way(place)).collect();
        let paint = |place: usize| paint_of[self.links[place].marker];
        // The first place on the way to `place` that the way to the other does not share, if both part.
        let fork =
            |place: usize, other: usize| ways[place].iter().copied().take_while(|at| !ways[other].contains(at)).last();
        let on = |fork: usize| (0..self.links.len()).filter(|&place| ways[place].contains(&fork)).collect::<Vec<_>>();
        let mut undecided = vec![false; self.links.len()];
        for one in 0..self.links.len() {
            for other in 0..one {
                let (Some(a), Some(b)) = (fork(one, other), fork(other, one)) else { continue };
                // A marker by itself is no branch.
                let lone = |fork: usize| self.links[fork].before.is_none() && self.children(fork) == 0;
                if paint(one) != paint(other) || lone(a) || lone(b) {
                    continue;
                }
                let (a, b) = (on(a), on(b));
                let is_fixed = |branch: &[usize]| branch.iter().any(|&place| fixed[place].is_some());
                let own_colour = |branch: &[usize], others: &[usize]| {
                    branch.iter().any(|&place| others.iter().all(|&there| paint(there) != paint(place)))
                };
                if !(is_fixed(&a) || is_fixed(&b) || own_colour(&a, &b) || own_colour(&b, &a)) {
                    (undecided[one], undecided[other]) = (true, true);
                }
            }
        }
        (0..undecided.len()).filter(|&place| undecided[place]).collect()
    }
}

/// Joints that flexion turns as the marker file says, whatever else the layout holds.
const FINGER_JOINTS: [&str; 3] = ["J1", "J2", "J3"];

/// The next segment whose parent is done; in a ring of joints the first one left.
fn next_segment(parent: &[Option<usize>], done: &[bool]) -> Option<usize> {
    let left = || (0..done.len()).filter(|&segment| !done[segment]);
    left().find(|&segment| parent[segment].is_none_or(|parent| done[parent])).or_else(|| left().next())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::path::Path;

    fn chain(text: &str) -> Vec<(String, Option<String>, bool)> {
        let layout = Layout::parse(text, Path::new("m.toml")).unwrap();
        let chain = Chain::new(&layout);
        let name = |place: usize| layout.markers[chain.links[place].marker].name.clone();
        (0..chain.links.len()).map(|k| (name(k), chain.links[k].before.map(name), chain.links[k].rigid)).collect()
    }

    fn link(name: &str, before: &str, rigid: bool) -> (String, Option<String>, bool) {
        (name.into(), (!before.is_empty()).then(|| before.into()), rigid)
    }

    #[test]
    fn joints_order_segments_and_shared_markers_are_one() {
        let text = "[markers]\na = '#ff0000'\nb = '#00ff00'\nc = '#0000ff'\nd = '#ffff00'\n\
            [segments]\nmiddle = ['b', 'c']\nproximal = ['a', 'b']\ndistal = ['c', 'd']\n\
            [joints]\nJ3 = ['middle', 'distal']\nJ2 = ['proximal', 'middle']\n";
        let expected = vec![link("a", "", false), link("b", "a", true), link("c", "b", true), link("d", "c", true)];
        assert_eq!(chain(text), expected);
    }

    /// Thumb and index finger from one mark at the wrist, `index` and `thumb` their colours, `tip` that of the
    /// thumb's tip.
    fn hand(index: &str, thumb: &str, tip: &str) -> Layout {
        let text = format!(
            "[markers]\nwrist = '{index}'\nmcp = '{index}'\npip = '{index}'\ncmc = '{thumb}'\nip = '{tip}'\n\
            [segments]\nhand = ['wrist', 'mcp']\nproximal = ['mcp', 'pip']\nbase = ['wrist', 'cmc']\nend = ['cmc', \
            'ip']\n\
            [joints]\nJ1 = ['hand', 'proximal']\nT = ['base', 'end']\n"
        );
        Layout::parse(&text, Path::new("m.toml")).unwrap()
    }

    #[test]
    fn thumb_and_index_hang_on_one_mark() {
        let green = "#2b4b10";
        let layout = hand(green, green, green);
        let chain = Chain::new(&layout);
        let befores: Vec<Option<usize>> = chain.links.iter().map(|link| link.before).collect();
        assert_eq!(befores, [None, Some(0), Some(1), Some(0), Some(3)], "{chain:?}");
        assert!(chain.links.iter().all(|link| link.rigid == link.before.is_some()));
        let bends: Vec<usize> =
            (0..5).filter(|&place| chain.links[place].bends).map(|p| chain.links[p].marker).collect();
        assert_eq!(bends, [2], "J1 bends as `flexion` says, the thumb as it may");
    }

    #[test]
    fn branches_of_one_colour_are_undecided_till_one_is_fixed() {
        let (green, blue) = ("#2b4b10", "#1e6fd9");
        let undecided = |layout: &Layout, fixed: &[usize]| {
            let colour = |marker: usize| layout.markers[marker].colour;
            let paint_of =
                |marker| (0..layout.markers.len()).position(|other| colour(other) == colour(marker)).unwrap();
            let paint_of: Vec<usize> = (0..layout.markers.len()).map(paint_of).collect();
            let chain = Chain::new(layout);
            let fixed: Vec<Option<usize>> =
                chain.links.iter().map(|link| fixed.contains(&link.marker).then_some(0)).collect();
            let places = chain.undecided(&paint_of, &fixed);
            places
                .into_iter()
                .map(|place| &*layout.markers[chain.links[place].marker].name)
                .collect::<Vec<_>>()
                .join(" ")
        };
        let one = hand(green, green, green);
        let all = undecided(&one, &[]);
        assert!(["mcp", "pip", "cmc", "ip"].iter().all(|name| all.contains(name)) && !all.contains("wrist"), "{all}");
        assert_eq!(undecided(&one, &[0]), all, "the wrist says nothing of the branches");
        assert_eq!(undecided(&one, &[4]), "");
        assert_eq!(undecided(&hand(green, blue, blue), &[]), "");
        assert_eq!(undecided(&hand(green, green, blue), &[]), "", "the thumb's tip says which branch is the thumb");
    }

    #[test]
    fn markers_of_a_common_colour_help_though_no_joint_asks() {
        let text = |colour: &str| {
            format!(
                "[markers]\na = '{colour}'\nb = '#ff0000'\nc = '#ff0000'\nd = '#ff0000'\ne = '#ff0000'\nf = \
                 '{colour}'\n\
                [segments]\nhand = ['a', 'b']\nproximal = ['c', 'd']\nmiddle = ['e', 'f']\n\
                [joints]\nJ1 = ['hand', 'proximal']\n"
            )
        };
        assert_eq!(chain(&text("#ff0000")).len(), 6);
        let some = chain(&text("#0000ff"));
        assert_eq!(some.len(), 6, "two blue ones could be taken for one another");
        assert_eq!(some[4], link("e", "d", false));
    }
}
