//! `switch.toml`: thresholds, holds, and what happens where nothing is known.

use serde::{Deserialize, Serialize};

/// What a prediction beyond the trained voltages does.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Outside {
    /// It lets go: a press ends as if the force had fallen, and a true release has to come before the next.
    Release,
    /// It is passed over, as if no sample had come; the watchdog runs.
    Ignore,
}

/// A switch's thresholds and times; what a file leaves out is 0 or off.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SwitchConfig {
    /// Pressed from this value on: newtons of pressing (-`Fz_N`), or of `column`.
    #[serde(rename = "on_N")]
    pub on_n: f64,
    /// Released below this value.
    #[serde(rename = "off_N")]
    pub off_n: f64,
    /// How long the value has to be at `on_N` or above, seconds.
    #[serde(default)]
    pub hold_on_s: f64,
    /// How long it has to be below `off_N`, seconds.
    #[serde(default)]
    pub hold_off_s: f64,
    /// No press for so long after a release, seconds.
    #[serde(default)]
    pub lockout_s: f64,
    /// A value that rises during the lock-out has to fall below `off_N` before it presses.
    #[serde(default)]
    pub rearm: bool,
    /// Without a valid sample for so long the switch lets go, and stays so until a true release and press, seconds;
    /// 0: never.
    #[serde(default)]
    pub watchdog_s: f64,
    /// What predictions beyond the trained voltages do; none: they count as any other.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub outside: Option<Outside>,
    /// The predicted column that is compared; none: pressing, -`Fz_N`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub column: Option<String>,
    /// The model on whose predictions the thresholds were chosen: the `sha256` of its file; none: not known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub model_sha256: Option<String>,
    /// What the switch does, for its events: `x+`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
    /// The finger that presses, for its events: `index`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub finger: Option<String>,
    /// Where which switch is, for a tracker's `x_m`, `y_m`; the place where the press begins decides.
    #[serde(default, rename = "place", skip_serializing_if = "Vec::is_empty")]
    pub places: Vec<Place>,
}

/// Nobody holds a finger for so long to be understood, nor waits for so long, seconds (assumed): longer ones are
/// milliseconds.
const LONGEST_HOLD_S: f64 = 10.0;
const LONGEST_S: f64 = 60.0;

/// A picture of a switch in the tracker's plane, metres: a rectangle or a disc.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Place {
    /// The switch.
    pub name: String,
    /// Left, bottom, right, top.
    #[serde(default, rename = "rectangle_m", skip_serializing_if = "Option::is_none")]
    pub rectangle_m: Option<[f64; 4]>,
    /// Centre x, y and radius.
    #[serde(default, rename = "disc_m", skip_serializing_if = "Option::is_none")]
    pub disc_m: Option<[f64; 3]>,
}

/// All that is wrong with a `switch.toml`, by its keys.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{}", .0.join("; "))]
pub struct ConfigFault(pub Vec<String>);

/// The predicted column that a switch compares (`column` of its file), and the factor that it is taken by.
#[must_use]
pub fn compared(column: Option<&str>) -> (&str, f64) {
    column.map_or(("Fz_N", -1.0), |column| (column, 1.0))
}

impl SwitchConfig {
    /// Pressed from `on_n` on, released below `off_n`; all else off.
    #[must_use]
    pub fn of(on_n: f64, off_n: f64) -> Self {
        Self { on_n, off_n, ..Self::default() }
    }

    /// Reads a file's text.
    ///
    /// # Errors
    /// Text that is no TOML or has unknown keys, with its line; values that can't be.
    pub fn from_toml(text: &str) -> Result<Self, ConfigFault> {
        let config: Self = toml::from_str(text).map_err(|why| ConfigFault(vec![why.to_string()]))?;
        config.check()?;
        Ok(config)
    }

    /// Can it work?
    pub fn check(&self) -> Result<(), ConfigFault> {
        let mut faults = Vec::new();
        let Self { on_n, off_n, .. } = *self;
        if !on_n.is_finite() || !off_n.is_finite() {
            faults.push(format!("on_N = {on_n}, off_N = {off_n}: write finite numbers"));
        } else if off_n > on_n {
            faults
                .push(format!("off_N = {off_n} is above on_N = {on_n}: the switch would let go as soon as it presses"));
        }
        // Of newtons: a finger that touches nothing presses with 0.
        if self.column.is_none() && on_n <= 0.0 {
            faults.push(format!("on_N = {on_n}: choose more than 0 N, as a finger that does not touch presses with 0"));
        }
        let times = [
            ("hold_on_s", self.hold_on_s, LONGEST_HOLD_S),
            ("hold_off_s", self.hold_off_s, LONGEST_HOLD_S),
            ("lockout_s", self.lockout_s, LONGEST_S),
            ("watchdog_s", self.watchdog_s, LONGEST_S),
        ];
        for (key, value, most) in times {
            if !(0.0..=most).contains(&value) {
                faults.push(format!("{key} = {value}: choose 0 to {most} s"));
            }
        }
        for place in &self.places {
            faults.extend(place.fault());
        }
        if faults.is_empty() { Ok(()) } else { Err(ConfigFault(faults)) }
    }

    /// The switch whose picture is at a place of the tracker's plane, metres: the first that holds it; none of several
    /// does.
    #[must_use]
    pub fn at(&self, x_m: f64, y_m: f64) -> Option<&str> {
        self.places.iter().find(|place| place.holds(x_m, y_m)).map(|place| place.name.as_str())
    }
}

impl Place {
    fn holds(&self, x_m: f64, y_m: f64) -> bool {
        let in_rectangle =
            |[left, bottom, right, top]: [f64; 4]| (left..=right).contains(&x_m) && (bottom..=top).contains(&y_m);
        let in_disc = |[x, y, radius]: [f64; 3]| (x_m - x).hypot(y_m - y) <= radius;
        self.rectangle_m.is_some_and(in_rectangle) || self.disc_m.is_some_and(in_disc)
    }

    fn fault(&self) -> Option<String> {
        let place = &self.name;
        match (self.rectangle_m, self.disc_m) {
            (Some([left, bottom, right, top]), None) => (!(left < right && bottom < top)).then(|| {
                format!(
                    "place `{place}`: rectangle_m is left, bottom, right, top; the first two are less than the others"
                )
            }),
            (None, Some([x, y, radius])) => (!(x.is_finite() && y.is_finite() && radius > 0.0))
                .then(|| format!("place `{place}`: disc_m is x, y and a radius above 0")),
            _ => Some(format!("place `{place}`: give it one of rectangle_m, disc_m")),
        }
    }
}
