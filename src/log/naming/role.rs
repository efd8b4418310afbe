//! What a column of a log is for, and the contract's names.

#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub(in crate::log) enum Role {
    /// `time_s`
    Time,
    /// `led`
    Led,
    /// `P1`, `P2`, ..
    Photodiode(u32),
    /// `VP1`, `VP2`, ..: a photodiode above a unit of the hemodynamic model.
    Output(u32),
    /// `Fx_N`, `Fy_N`, `Fz_N`, counted from 0.
    Force(u8),
    /// `pf1_Pa`, `pf2_Pa`, `ph_Pa`, `pl_Pa`, counted from 0.
    Pressure(u8),
    /// `contact`: whether the finger truly touches, 1 or 0. Only where the user says so, as logs have columns of this
    /// name that hold words.
    Contact,
}

/// The hemodynamic model's pressures.
const PRESSURES: [&str; 4] = ["pf1_Pa", "pf2_Pa", "ph_Pa", "pl_Pa"];

impl Role {
    /// The contract's name.
    pub(in crate::log) fn name(self) -> String {
        match self {
            Self::Time => "time_s".to_owned(),
            Self::Led => "led".to_owned(),
            Self::Photodiode(number) => format!("P{number}"),
            Self::Output(number) => format!("VP{number}"),
            Self::Force(axis) => format!("F{}_N", ["x", "y", "z"][usize::from(axis.min(2))]),
            Self::Pressure(which) => PRESSURES[usize::from(which.min(3))].to_owned(),
            Self::Contact => "contact".to_owned(),
        }
    }

    /// Whether it is light: what the LED shines through, and the ambient light is taken away from.
    pub(in crate::log) fn is_light(self) -> bool {
        matches!(self, Self::Photodiode(_) | Self::Output(_))
    }

    /// Whether it is a load, which the LED does not change.
    pub(in crate::log) fn is_load(self) -> bool {
        matches!(self, Self::Force(_) | Self::Pressure(_) | Self::Contact)
    }

    /// The role of one of the contract's names.
    pub(in crate::log) fn of(name: &str) -> Option<Self> {
        match name {
            "time_s" => Some(Self::Time),
            "led" => Some(Self::Led),
            "Fx_N" => Some(Self::Force(0)),
            "Fy_N" => Some(Self::Force(1)),
            "Fz_N" => Some(Self::Force(2)),
            "contact" => Some(Self::Contact),
            _ => {
                let number = |prefix: &str| -> Option<u32> {
                    let digits = name.strip_prefix(prefix)?;
                    let plain = !digits.starts_with('0') && digits.bytes().all(|b| b.is_ascii_digit());
                    digits.parse().ok().filter(|_| plain)
                };
                let pressure = || PRESSURES.iter().position(|own| *own == name).map(|k| Self::Pressure(k as u8));
                let light = number("P").map(Self::Photodiode).or_else(|| number("VP").map(Self::Output));
                light.or_else(pressure)
            }
        }
    }
}
