//! Motion to whole counts, exactly: what is less than a count is carried over, and the last of it can be taken back.
//!
//! In: steps, px. Out: counts whose sum is never a whole count away from the sum of the steps less what was taken
//! back. What is left over is cut, not rounded: noise about a half then does not make the pointer tremble.

/// Moments that the motion to be taken back is kept in: motion of so long is one sum.
const MOMENTS: usize = 64;

/// The way, and how much of it was reported.
#[derive(Debug, Clone)]
pub(super) struct Counts {
    /// Steps that were not yet reported, px.
    left_px: [f64; 2],
    /// Counts that were.
    reported: [i64; 2],
    /// How long one moment is, s; 0 where nothing is ever taken back.
    moment_s: f64,
    /// The motion of each of the last moments, px, with the moment's number.
    recent: [(i64, [f64; 2]); MOMENTS],
}

impl Counts {
    /// `take_back_s`: how much of the motion can be taken back, s, to a 64th of it.
    pub(super) fn new(take_back_s: f64) -> Self {
        let moment_s = take_back_s / MOMENTS as f64;
        Self { left_px: [0.0; 2], reported: [0; 2], moment_s, recent: [(i64::MIN, [0.0; 2]); MOMENTS] }
    }

    /// A step at `t_s`.
    pub(super) fn push(&mut self, t_s: f64, step_px: [f64; 2]) {
        add(&mut self.left_px, step_px);
        if self.moment_s > 0.0 {
            let moment = self.moment(t_s);
            let kept = &mut self.recent[moment.rem_euclid(MOMENTS as i64) as usize];
            if kept.0 != moment {
                *kept = (moment, [0.0; 2]);
            }
            add(&mut kept.1, step_px);
        }
    }

    /// The motion of the last `take_back_s` before `t_s`, px.
    pub(super) fn recent_px(&self, t_s: f64) -> [f64; 2] {
        let mut sum = [0.0; 2];
        if self.moment_s > 0.0 {
            let now = self.moment(t_s);
            let last = self.recent.iter().filter(|kept| kept.0 <= now && now.saturating_sub(kept.0) < MOMENTS as i64);
            last.for_each(|kept| add(&mut sum, kept.1));
        }
        sum
    }

    /// Takes motion back; nothing of what came before can be taken back again.
    pub(super) fn take_back(&mut self, motion_px: [f64; 2]) {
        add(&mut self.left_px, motion_px.map(|part| -part));
        self.forget_recent();
    }

    /// What was moved so far can't be taken back any more.
    pub(super) fn forget_recent(&mut self) {
        self.recent = [(i64::MIN, [0.0; 2]); MOMENTS];
    }

    /// Whole counts to report; none where there are none.
    pub(super) fn whole(&mut self) -> Option<[i32; 2]> {
        let counts = self.left_px.map(|part| part as i32);
        if counts == [0, 0] {
            return None;
        }
        for (axis, &count) in counts.iter().enumerate() {
            self.left_px[axis] -= f64::from(count);
            self.reported[axis] += i64::from(count);
        }
        Some(counts)
    }

    /// Where the pointer is, px from where it began.
    pub(super) fn place_px(&self) -> [f64; 2] {
        std::array::from_fn(|axis| self.reported[axis] as f64 + self.left_px[axis])
    }

    fn moment(&self, t_s: f64) -> i64 {
        (t_s / self.moment_s).floor() as i64
    }
}

fn add(sum: &mut [f64; 2], step: [f64; 2]) {
    sum[0] += step[0];
    sum[1] += step[1];
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    /// Sums of some hundred steps of up to 1e3 px: rounding is far below; measured 4e-12.
    const NEAR: f64 = 1e-9;

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(500))]

        /// Against a naive twin that keeps every step.
        #[test]
        fn whole_counts_are_never_a_count_away_from_the_steps(
            steps in proptest::collection::vec((1e-4..0.02_f64, -3.0..3.0_f64, -40.0..40.0_f64, 0..12_u8), 1..300),
            take_back_s in 0.0..0.2_f64,
        ) {
            let mut counts = Counts::new(take_back_s);
            let (mut t_s, mut reported, mut taken) = (1000.0, [0i64; 2], [0.0; 2]);
            let mut all: Vec<(f64, [f64; 2], bool)> = Vec::new();
            for (dt_s, dx, dy, turn) in steps {
                t_s += dt_s;
                counts.push(t_s, [dx, dy]);
                all.push((t_s, [dx, dy], true));
                if turn == 0 {
                    let moment = |t: f64| (t / (take_back_s / 64.0)).floor();
                    let back: [f64; 2] = std::array::from_fn(|axis| {
                        let recent = all.iter().filter(|(t, _, open)| *open && moment(t_s) - moment(*t) < 64.0);
                        recent.map(|(_, step, _)| step[axis]).sum()
                    });
                    let got = counts.recent_px(t_s);
                    for axis in 0..2 {
                        prop_assert!((got[axis] - back[axis]).abs() <= NEAR, "{:?} {:?}", got, back);
                        taken[axis] += back[axis];
                    }
                    counts.take_back(got);
                    all.iter_mut().for_each(|step| step.2 = false);
                }
                if let Some(whole) = counts.whole() {
                    reported = [reported[0] + i64::from(whole[0]), reported[1] + i64::from(whole[1])];
                }
                for axis in 0..2 {
                    let exact: f64 = all.iter().map(|step| step.1[axis]).sum::<f64>() - taken[axis];
                    prop_assert!((exact - reported[axis] as f64).abs() < 1.0 + NEAR, "{exact} {}", reported[axis]);
                    prop_assert!((exact - counts.place_px()[axis]).abs() <= NEAR);
                }
            }
        }
    }

    #[test]
    fn slow_motion_is_not_lost_and_noise_about_a_half_does_not_tremble() {
        let mut counts = Counts::new(0.06);
        let mut reported = 0;
        for k in 0..1000 {
            counts.push(f64::from(k) * 0.001, [0.0101, 0.0]);
            reported += counts.whole().map_or(0, |whole| whole[0]);
        }
        assert_eq!(reported, 10);
        let mut turns = 0;
        for k in 0..1000 {
            counts.push(2.0 + f64::from(k) * 0.001, [if k % 2 == 0 { 0.6 } else { -0.6 }, 0.0]);
            turns += i32::from(counts.whole().is_some());
        }
        assert!(turns <= 1, "{turns}");
    }
}
