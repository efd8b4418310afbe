//! Which trajectory: the options of the three kinds, on the command line and in pipelines, and what follows from them.

use clap::Args;
use lunula_predictor::{Bending, ForceSpace, Spiral};
use serde::Serialize;

/// Which way through the space of forces, or of postures. Rates in hertz.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "lowercase", tag = "kind")]
pub enum Kind {
    /// The spiral of equations 21 to 23.
    Force {
        /// f_s, cycles a newton.
        fs_per_n: f64,
        /// f_c.
        fc_hz: f64,
    },
    /// Random forces within the cone of friction.
    Random {
        /// Rates lie between 0.4 and 4 times this.
        hz: f64,
        /// Where the random numbers come from.
        seed: u64,
    },
    /// Equation 27, or random bending within its range.
    Posture {
        /// f_b; of random bending, rates lie between 0.4 and 4 times this.
        hz: f64,
        /// Of random bending, where the random numbers come from.
        seed: Option<u64>,
    },
}

/// A trajectory, with all that a kind leaves to defaults.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct TrajectoryOptions {
    /// Which.
    #[serde(flatten)]
    pub kind: Kind,
    /// How long it takes (T of the spiral), without lead and trail.
    pub seconds: f64,
    /// Between rows.
    pub every_s: f64,
    /// At rest before it begins.
    pub lead_s: f64,
    /// After its end: the finger lets go and rests.
    pub trail_s: f64,
    /// How long forces, and random angles, take to come out of rest.
    pub soft_s: f64,
    /// The largest pressing.
    pub fz_max_n: f64,
    /// The coefficient of friction.
    pub mu: f64,
    /// tau of equation 19.
    pub tau_s: f64,
    /// The error that equation 19 may come to, as a share.
    pub error: f64,
}

impl TrajectoryOptions {
    /// The thesis' own figures.
    #[must_use]
    pub fn of(kind: Kind) -> Self {
        let (spiral, space) = (Spiral::default(), ForceSpace::default());
        Self {
            kind,
            seconds: match kind {
                Kind::Force { .. } => spiral.duration_s,
                Kind::Random { .. } => 100.0,
                Kind::Posture { .. } => Bending::PROTOCOL_S,
            },
            every_s: 0.04,
            lead_s: 0.0,
            trail_s: 0.0,
            // The spiral begins with little force, random motion anywhere.
            soft_s: match kind {
                Kind::Random { .. } => 5.0,
                // Equation 27 begins at rest by itself.
                Kind::Posture { seed: None, .. } => 0.0,
                _ => spiral.soft_s,
            },
            fz_max_n: space.fz_max_n(),
            mu: space.mu(),
            tau_s: 0.1,
            error: 0.1,
        }
    }

    /// With lead and trail.
    #[must_use]
    pub fn whole_s(&self) -> f64 {
        self.lead_s + self.seconds + self.trail_s
    }

    /// Rows of the table: one every [`every_s`](Self::every_s) from 0 on, the end counted.
    #[must_use]
    pub fn rows(&self) -> f64 {
        // 180 / 0.04 is a little less than 4500 in floating point.
        (self.whole_s() / self.every_s * (1.0 + 1e-12)).floor() + 1.0
    }

    /// Whether it is one of forces.
    #[must_use]
    pub fn is_force(&self) -> bool {
        !matches!(self.kind, Kind::Posture { .. })
    }
}

/// What every trajectory takes.
#[derive(Debug, Clone, Copy, Args)]
struct Timing {
    /// The time between two rows
    #[arg(long = "every", value_name = "SECONDS", default_value_t = 0.04, allow_negative_numbers = true)]
    every_s: f64,
    /// At rest for so long before it begins
    #[arg(long = "lead", value_name = "SECONDS", default_value_t = 0.0, allow_negative_numbers = true)]
    lead_s: f64,
    /// The table goes on for so long after its end: the finger lets go within 2 s, or stays where it bent to
    #[arg(long = "trail", value_name = "SECONDS", default_value_t = 0.0, allow_negative_numbers = true)]
    trail_s: f64,
    /// The sensor's slowest time constant, for equation 19
    #[arg(long = "tau", value_name = "SECONDS", default_value_t = 0.1, allow_negative_numbers = true)]
    tau_s: f64,
}

impl Timing {
    fn options(self, kind: Kind, seconds: f64) -> TrajectoryOptions {
        let Self { every_s, lead_s, trail_s, tau_s } = self;
        TrajectoryOptions { seconds, every_s, lead_s, trail_s, tau_s, ..TrajectoryOptions::of(kind) }
    }
}

/// The cone of the forces that can be, and how it is entered.
#[derive(Debug, Clone, Copy, Args)]
struct Cone {
    /// The largest pressing force
    #[arg(long = "fz-max", value_name = "NEWTONS", default_value_t = 3.0, allow_negative_numbers = true)]
    fz_max_n: f64,
    /// The coefficient of friction
    #[arg(long, default_value_t = 0.75, allow_negative_numbers = true)]
    mu: f64,
    /// How long forces take to come out of rest; 0: no time, as equation 21 is printed, which begins infinitely fast
    /// [default: 2, random forces 5]
    #[arg(long = "soft-start", value_name = "SECONDS", allow_negative_numbers = true)]
    soft_s: Option<f64>,
    /// The largest error that equation 19 may reach
    #[arg(long, value_name = "PERCENT", default_value_t = 10.0, allow_negative_numbers = true)]
    error: f64,
}

impl Cone {
    fn of(self, options: TrajectoryOptions) -> TrajectoryOptions {
        let soft_s = self.soft_s.unwrap_or(options.soft_s);
        TrajectoryOptions { fz_max_n: self.fz_max_n, mu: self.mu, soft_s, error: 0.01 * self.error, ..options }
    }
}

/// The options of one kind of trajectory.
pub trait KindOptions: Args {
    /// What follows from them.
    fn options(&self) -> TrajectoryOptions;
}

/// The spiral of equations 21 to 23.
#[derive(Debug, Clone, Copy, Args)]
pub struct ForceOptions {
    /// T, how long it takes
    #[arg(long, default_value_t = 180.0, allow_negative_numbers = true)]
    seconds: f64,
    /// f_s: how often it goes in and out, in cycles per newton
    #[arg(long = "fs", value_name = "CYCLES", default_value_t = 1.0, allow_negative_numbers = true)]
    fs_per_n: f64,
    /// f_c: how often it circles
    #[arg(long = "fc", value_name = "HZ", default_value_t = 0.15, allow_negative_numbers = true)]
    fc_hz: f64,
    #[command(flatten)]
    cone: Cone,
    #[command(flatten)]
    timing: Timing,
}

impl KindOptions for ForceOptions {
    fn options(&self) -> TrajectoryOptions {
        let kind = Kind::Force { fs_per_n: self.fs_per_n, fc_hz: self.fc_hz };
        self.cone.of(self.timing.options(kind, self.seconds))
    }
}

/// Equation 27, or random bending within its range.
#[derive(Debug, Clone, Copy, Args)]
pub struct BendingOptions {
    /// How long it takes
    #[arg(long, default_value_t = 60.0, allow_negative_numbers = true)]
    seconds: f64,
    /// f_b, the rate of bending; random bending has rates of 0.4 to 4 times it
    #[arg(long, default_value_t = 0.1, allow_negative_numbers = true)]
    hz: f64,
    /// Smooth random bending, for tests
    #[arg(long)]
    random: bool,
    /// The seed of random bending
    #[arg(long, default_value_t = 1, requires = "random")]
    seed: u64,
    /// How long random bending takes to come out of rest
    #[arg(
        long = "soft-start",
        value_name = "SECONDS",
        default_value_t = 2.0,
        allow_negative_numbers = true,
        requires = "random"
    )]
    soft_s: f64,
    #[command(flatten)]
    timing: Timing,
}

impl KindOptions for BendingOptions {
    fn options(&self) -> TrajectoryOptions {
        let kind = Kind::Posture { hz: self.hz, seed: self.random.then_some(self.seed) };
        let options = self.timing.options(kind, self.seconds);
        TrajectoryOptions { soft_s: if self.random { self.soft_s } else { options.soft_s }, ..options }
    }
}

/// Smooth random forces within the cone of friction.
#[derive(Debug, Clone, Copy, Args)]
pub struct RandomOptions {
    /// How long it takes
    #[arg(long, default_value_t = 100.0, allow_negative_numbers = true)]
    seconds: f64,
    /// Rates are between 0.4 and 4 times this; at 0.03, equation 19's default limit is kept but for 1 % of the time
    #[arg(long, default_value_t = 0.03, allow_negative_numbers = true)]
    hz: f64,
    /// The seed of everything random
    #[arg(long, default_value_t = 1)]
    seed: u64,
    #[command(flatten)]
    cone: Cone,
    #[command(flatten)]
    timing: Timing,
}

impl KindOptions for RandomOptions {
    fn options(&self) -> TrajectoryOptions {
        let kind = Kind::Random { hz: self.hz, seed: self.seed };
        self.cone.of(self.timing.options(kind, self.seconds))
    }
}
