//! A trajectory over the table's time: at rest, then on its way, then at rest again.

use lunula_predictor::{Bending, ForceSpace, ForceSpaceFault, RandomBending, RandomForce, Spiral};

use super::{Kind, TrajectoryOptions};

/// Ready to be asked often.
#[derive(Debug, Clone)]
pub(super) enum Motion {
    Force(Box<ForceMotion>),
    Posture { path: Path, lead_s: f64, seconds: f64 },
}

#[derive(Debug, Clone, Copy)]
pub(super) struct ForceMotion {
    pub(super) space: ForceSpace,
    pub(super) spiral: Option<Spiral>,
    random: RandomForce,
    lead_s: f64,
}

#[derive(Debug, Clone, Copy)]
pub(super) enum Path {
    Bending(Bending),
    Random(RandomBending),
}

impl Motion {
    pub(super) fn new(options: &TrajectoryOptions) -> Result<Self, ForceSpaceFault> {
        let force = |spiral: Option<Spiral>, hz: f64, seed: u64| {
            let space = ForceSpace::new(options.fz_max_n, options.mu)?;
            let random = RandomForce::even(space, hz, seed).out_of_rest(options.soft_s, options.seconds);
            Ok(Self::Force(Box::new(ForceMotion { space, spiral, random, lead_s: options.lead_s })))
        };
        match options.kind {
            Kind::Force { fs_per_n, fc_hz } => {
                let spiral = Spiral {
                    fz_max_n: options.fz_max_n,
                    duration_s: options.seconds,
                    mu: options.mu,
                    fs_per_n,
                    fc_hz,
                    soft_s: options.soft_s,
                };
                force(Some(spiral), 0.0, 0)
            }
            Kind::Random { hz, seed } => force(None, hz, seed),
            Kind::Posture { hz, seed } => {
                let path = match seed {
                    None => Path::Bending(Bending { hz }),
                    Some(seed) => Path::Random(RandomBending::new(hz, options.soft_s, seed)),
                };
                Ok(Self::Posture { path, lead_s: options.lead_s, seconds: options.seconds })
            }
        }
    }

    /// Forces in newtons, or the angle in degrees and nothing else, at the table's time.
    pub(super) fn at(&self, time_s: f64) -> [f64; 3] {
        match self {
            Self::Force(motion) => motion.at(time_s),
            Self::Posture { path, lead_s, seconds } => [path.during(time_s, *lead_s, *seconds), 0.0, 0.0],
        }
    }
}

impl ForceMotion {
    /// `[Fx, Fy, Fz]`, newtons, at the table's time.
    pub(super) fn at(&self, time_s: f64) -> [f64; 3] {
        let t_s = time_s - self.lead_s;
        match self.spiral {
            Some(spiral) => spiral.forces_n(t_s),
            None if t_s < 0.0 => [0.0; 3],
            None => self.random.forces_n(t_s),
        }
    }

    /// How far along its direction the finger shears: F_r of equation 22 with its sign, of random motion the size.
    pub(super) fn radial_n(&self, time_s: f64) -> f64 {
        let [fx_n, fy_n, fz_n] = self.at(time_s);
        match self.spiral {
            Some(spiral) => fx_n.hypot(fy_n).copysign(spiral.shear_n(-fz_n)),
            None => fx_n.hypot(fy_n),
        }
    }
}

impl Path {
    /// J2, degrees, at a time from the trajectory's beginning on.
    fn at(&self, t_s: f64) -> f64 {
        match self {
            Self::Bending(bending) => bending.j2_deg(t_s),
            Self::Random(random) => random.j2_deg(t_s),
        }
    }

    /// J2, degrees, at the table's time: before and after, it stays where it begins and ends.
    pub(super) fn during(&self, time_s: f64, lead_s: f64, seconds: f64) -> f64 {
        self.at((time_s - lead_s).clamp(0.0, seconds))
    }
}
