//! Logs of photodiodes and forces, in words.

use std::path::PathBuf;

use clap::{Args, ValueEnum};

use super::choices::{parse_photodiode, positions, trajectory};
use super::worn::WornRequest;
use crate::phantom::log::{LogOptions, Protocol, SensorModel};
use crate::phantom::motion::force::{Cycles, ForceTrajectory, Spiral};
use crate::phantom::motion::trajectory::Trajectory;

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum ForceArg {
    /// The finger touches nothing
    None,
    /// Equations 21 to 23, with a soft start, the finger straight
    Spiral,
    /// Smooth and random within the cone of friction, most of it about its middle
    Random,
    /// Smooth and random, about evenly all over the cone
    Even,
    /// Fz from 0 to -4 N and back
    Normal,
    /// Fx from 2 N to -2 N and back while Fz is held at -3 N
    Lateral,
    /// Fy from 2 N to -2 N and back while Fz is held at -3 N
    Longitudinal,
    /// Presses, holds, slides, taps and near misses of the finger's own, with pauses
    Contacts,
}

/// What `lunula phantom log` takes.
#[derive(Debug, Clone, Args)]
pub struct LogRequest {
    /// Seed of everything random but the person and the session
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Whose finger it is
    #[arg(long, value_name = "K", default_value_t = 1)]
    subject: u32,
    /// Which day: the sensor is put on again, its gains and offsets change by a few per cent
    #[arg(long, value_name = "K", default_value_t = 1)]
    session: u32,
    /// What the volts come from: formulae after the words of 3.3, or the colour of the nail below each photodiode, that
    /// of `lunula phantom nailvideo` of the same --subject
    #[arg(long, value_enum, default_value = "formulae")]
    sensor: SensorModel,
    /// Where the photodiodes are on the nail, of --sensor nail: a positions.toml or layout.json of up to 8 [default:
    /// the thesis' eight, read off its words]
    #[arg(long, value_name = "FILE")]
    positions: Option<PathBuf>,

    /// An experiment of 3.3, 5.2.4 and 5.3, prompted to a finger that follows as people do; the options below change
    /// it. Repetitions have the same --subject and --session and other seeds
    #[arg(long, value_enum)]
    protocol: Option<Protocol>,
    /// How well the finger follows: the standard deviation of its error as a share, about 0.3 s late (assumed; 5.2.2a
    /// quotes 6 %); 0: exactly [default: 0; with a protocol of the thesis 0.06]
    #[arg(long, value_name = "SHARE", allow_negative_numbers = true)]
    follow: Option<f64>,
    /// The finger touches or rests by up to so many degrees of J2 off straight, the same all along a log and another
    /// for each seed (assumed, after 5.4.1) [default: 0; with a protocol 3]
    #[arg(long, value_name = "DEGREES", allow_negative_numbers = true)]
    posture_shift: Option<f64>,
    /// The finger bends and touches nothing until then, and presses, straight, from then on [default: it does both all
    /// along; with a protocol that touches after its bending]
    #[arg(long, value_name = "SECONDS", allow_negative_numbers = true)]
    touch_from: Option<f64>,
    /// Joint angles over time: eq27, free (fully flexed to fully extended and back), random, even (random, all over
    /// equation 27's range), rest (straight and still), sway (straight, as people rest), or a table (CSV or Parquet)
    /// with time_s, J1_deg, J2_deg, J3_deg [default: eq27; with --force spiral, normal, lateral or longitudinal rest,
    /// with contacts sway, with --force random or even random, but eq27 with --touch-from]
    #[arg(long, value_name = "eq27|free|random|even|rest|sway|FILE")]
    trajectory: Option<String>,
    /// Bending rate f of equation 27; random movement has rates of 0.4 to 4 times it
    #[arg(long, value_name = "HZ", default_value_t = 0.1)]
    bend_hz: f64,
    /// How the fingertip presses and shears [default: none, or as the protocol]
    #[arg(long, value_enum)]
    force: Option<ForceArg>,
    /// The spiral's T [default: 180]
    #[arg(long, value_name = "SECONDS")]
    spiral_seconds: Option<f64>,
    /// Random forces have rates of 0.4 to 4 times it; normal, lateral and longitudinal forces come back so often
    /// [default: 0.1; of the latter 0.05]
    #[arg(long, value_name = "HZ")]
    force_hz: Option<f64>,

    /// The video's length [default: 10, or as long as a given trajectory, or the spiral's T, or the protocol]
    #[arg(long)]
    seconds: Option<f64>,
    #[command(flatten)]
    log: LogOptions,
    #[command(flatten)]
    worn: WornRequest,
    /// P2 and P3 are amplified so much that a fifth of their lit readings is cut at 10 V
    #[arg(long)]
    saturate: bool,
    /// This photodiode reads 0 V, as P6; again for more
    #[arg(long, value_name = "NAME", value_parser = parse_photodiode)]
    dead: Vec<usize>,
}

impl LogRequest {
    /// The log that is wanted.
    ///
    /// # Errors
    /// A trajectory's table that can't be read.
    pub fn options(&self) -> anyhow::Result<LogOptions> {
        let protocol = self.protocol;
        let kind = self.force.unwrap_or(match protocol {
            Some(Protocol::Touch) => ForceArg::Spiral,
            Some(Protocol::TouchRandom) => ForceArg::Even,
            Some(Protocol::Normal) => ForceArg::Normal,
            Some(Protocol::Lateral) => ForceArg::Lateral,
            Some(Protocol::Longitudinal) => ForceArg::Longitudinal,
            Some(Protocol::Contacts | Protocol::Rest) => ForceArg::Contacts,
            _ => ForceArg::None,
        });
        let spiral_s = self.spiral_seconds.unwrap_or(Spiral::default().duration_s);
        if self.spiral_seconds.is_some() && kind != ForceArg::Spiral {
            anyhow::bail!("--spiral-seconds: there is no spiral; choose --force spiral");
        }
        if self.force_hz.is_some() && matches!(kind, ForceArg::None | ForceArg::Spiral | ForceArg::Contacts) {
            anyhow::bail!("--force-hz: the force has no such rate; choose --force random, even, normal, ..");
        }
        let random_hz = self.force_hz.unwrap_or(0.1);
        let cycles = |which| ForceTrajectory::Cycles { which, hz: self.force_hz.unwrap_or(Cycles::HZ) };
        let force = match kind {
            ForceArg::None => ForceTrajectory::None,
            ForceArg::Spiral => ForceTrajectory::Spiral(Spiral { duration_s: spiral_s, ..Spiral::default() }),
            ForceArg::Random => ForceTrajectory::Random { hz: random_hz, seed: self.seed },
            ForceArg::Even => ForceTrajectory::Even { hz: random_hz, seed: self.seed },
            ForceArg::Normal => cycles(Cycles::Normal),
            ForceArg::Lateral => cycles(Cycles::Lateral),
            ForceArg::Longitudinal => cycles(Cycles::Longitudinal),
            ForceArg::Contacts => {
                let usual = protocol.and_then(|protocol| protocol.contacts(self.seed));
                ForceTrajectory::Contacts(self.worn.contacts(usual, self.seed))
            }
        };
        if kind != ForceArg::Contacts && self.worn.says_contacts() {
            anyhow::bail!("--kinds, --pause: the finger makes no contacts of its own; choose --force contacts");
        }
        let usual = protocol.map_or_else(LogOptions::default, |protocol| LogOptions::of(protocol, self.seed));
        let touch_from_s = self.touch_from.or(usual.touch_from_s.filter(|_| kind != ForceArg::None));
        let movement = match (kind, protocol) {
            (_, Some(Protocol::BendingRandom)) => "even",
            (_, Some(Protocol::FreeBending)) => "free",
            (_, Some(Protocol::Contacts | Protocol::Rest)) | (ForceArg::Contacts, None) => "sway",
            (_, Some(Protocol::Normal | Protocol::Lateral | Protocol::Longitudinal)) => "rest",
            (ForceArg::Spiral | ForceArg::Normal | ForceArg::Lateral | ForceArg::Longitudinal, None)
                if touch_from_s.is_none() =>
            {
                "rest"
            }
            (ForceArg::Random | ForceArg::Even, None) if touch_from_s.is_none() => "random",
            _ => "eq27",
        };
        let wanted = self.trajectory.as_deref().unwrap_or(movement);
        let (trajectory, span_s): (Trajectory, _) = trajectory(wanted, self.bend_hz, self.seed)?;
        let touching_s = match kind {
            ForceArg::Spiral => Some(spiral_s),
            ForceArg::Random | ForceArg::Even => {
                protocol.map(|protocol| protocol.seconds()[1]).filter(|seconds| *seconds > 0.0)
            }
            ForceArg::Normal | ForceArg::Lateral | ForceArg::Longitudinal => {
                Some(f64::from(Cycles::COUNT) / self.force_hz.unwrap_or(Cycles::HZ))
                    .filter(|seconds| seconds.is_finite())
            }
            ForceArg::None | ForceArg::Contacts => None,
        };
        let after_s = touching_s.map(|seconds| touch_from_s.unwrap_or(0.0) + seconds);
        Ok(LogOptions {
            seed: self.seed,
            subject: self.subject,
            session: self.session,
            sensor: self.sensor,
            positions: self.positions.as_deref().map(positions).transpose()?,
            trajectory,
            force,
            touch_from_s,
            follow: self.follow.unwrap_or(usual.follow),
            posture_shift_rad: self.posture_shift.map_or(usual.posture_shift_rad, f64::to_radians),
            seconds: self
                .seconds
                .or(after_s.filter(|_| touch_from_s.is_some()))
                .or(span_s)
                .or(after_s)
                .unwrap_or(usual.seconds),
            disturbances: self.worn.disturbances(usual.disturbances),
            forces: !self.worn.no_forces,
            contact: self.worn.contact,
            saturate: self.saturate,
            dead: self.dead.clone(),
            ..self.log.clone()
        })
    }
}
