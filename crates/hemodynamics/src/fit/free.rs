//! What a fit may change: groups of parameters that move together, within bounds, in coordinates of about unit size.

use super::FitFault;
use crate::parameters::{Parameters, Symbol};

/// Parameters that are free, and move together by one common factor, as the thesis' `k_C1 = k_C2` do.
///
/// A parameter that can't be negative moves by a factor and is fitted in its logarithm. Blood pressures, shares of the
/// load, offsets and scalings move by addition and have to be alone in their group.
#[derive(Clone, Debug, PartialEq)]
pub struct Free {
    /// The parameters.
    pub symbols: Vec<Symbol>,
    /// Where they may go.
    pub bounds: Bounds,
}

/// Where free parameters may go.
#[derive(Clone, Copy, Debug, PartialEq, Default)]
pub enum Bounds {
    /// What moves by a factor: a tenth to ten times the start ("within an order of magnitude"). A share of the load: 0
    /// to 1. All others:
    /// anywhere.
    #[default]
    Default,
    /// Factors on the start, the lower and the upper one; for what moves by a factor.
    Factors(f64, f64),
    /// Values of the first symbol, the lower and the upper one.
    Values(f64, f64),
}

impl std::str::FromStr for Bounds {
    type Err = String;

    /// `LOW..HIGH` in the parameter's unit, as `200..5000`, or of its start, as `0.1x..10x`.
    fn from_str(text: &str) -> Result<Bounds, String> {
        let wrong = || {
            format!("{text:?}: write LOW..HIGH in the parameter's unit, as 200..5000, or of its start, as 0.1x..10x")
        };
        let (low, high) = text.split_once("..").ok_or_else(wrong)?;
        let number = |part: &str| part.trim().parse::<f64>().ok().filter(|value| value.is_finite()).ok_or_else(wrong);
        match (low.trim().strip_suffix('x'), high.trim().strip_suffix('x')) {
            (Some(low), Some(high)) => Ok(Bounds::Factors(number(low)?, number(high)?)),
            (None, None) => Ok(Bounds::Values(number(low)?, number(high)?)),
            _ => Err(wrong()),
        }
    }
}

impl Free {
    /// One parameter within its default bounds.
    pub fn one(symbol: Symbol) -> Free {
        Free::tied(&[symbol])
    }

    /// Parameters tied by a common factor, within the default bounds.
    pub fn tied(symbols: &[Symbol]) -> Free {
        Free { symbols: symbols.to_vec(), bounds: Bounds::Default }
    }

    /// The same within other bounds.
    pub fn within(self, bounds: Bounds) -> Free {
        Free { bounds, ..self }
    }
}

/// A group as a coordinate of the fit: the logarithm of the factor, or the change over a scale.
#[derive(Clone, Debug)]
pub(super) struct Coordinate {
    pub(super) symbols: Vec<Symbol>,
    pub(super) start: Vec<f64>,
    /// `None`: by a factor. Otherwise the change that counts as 1.
    scale: Option<f64>,
    pub(super) lower: f64,
    pub(super) upper: f64,
}

impl Coordinate {
    /// `voltage_v` is the size of a change of voltage.
    pub(super) fn new(free: &Free, start: &Parameters, voltage_v: f64) -> Result<Coordinate, FitFault> {
        let first = *free.symbols.first().ok_or(FitFault::EmptyGroup)?;
        let mut values = Vec::with_capacity(free.symbols.len());
        for &symbol in &free.symbols {
            values.push(start.get(symbol).ok_or(FitFault::NoSuchParameter { symbol })?);
        }
        let pressure = (start.upstream_pa() - start.downstream_pa()).abs();
        let scale_of = |symbol: Symbol| match symbol {
            Symbol::Upstream | Symbol::Downstream => Some(if pressure > 0.0 { pressure } else { 1e4 }),
            Symbol::Offset(_) | Symbol::Scaling(_) => Some(voltage_v),
            Symbol::LoadShare(_) => Some(1.0),
            _ => None,
        };
        let scale = scale_of(first);
        if free.symbols.len() > 1
            && let Some(&symbol) = free.symbols.iter().find(|symbol| scale_of(**symbol).is_some())
        {
            return Err(FitFault::Tied { symbol });
        }
        if scale.is_none()
            && let Some(k) = values.iter().position(|&value| value == 0.0)
        {
            return Err(FitFault::Zero { symbol: free.symbols[k] });
        }
        let of_value = |value: f64| match scale {
            None => libm::log(value / values[0]),
            Some(scale) => (value - values[0]) / scale,
        };
        let wrong = |lower: f64, upper: f64| FitFault::Bounds { symbol: first, lower, upper };
        let (lower, upper) = match (free.bounds, scale) {
            (Bounds::Default, None) => (-TENFOLD, TENFOLD),
            (Bounds::Default, Some(_)) if matches!(first, Symbol::LoadShare(_)) => (of_value(0.0), of_value(1.0)),
            (Bounds::Default, Some(_)) => (f64::NEG_INFINITY, f64::INFINITY),
            (Bounds::Factors(lower, upper), None) if lower > 0.0 && upper.is_finite() => {
                (libm::log(lower), libm::log(upper))
            }
            (Bounds::Values(lower, upper), None) if lower > 0.0 && upper.is_finite() => {
                (of_value(lower), of_value(upper))
            }
            (Bounds::Values(lower, upper), Some(_)) if !(matches!(first, Symbol::LoadShare(_)) && lower < 0.0) => {
                (of_value(lower), of_value(upper))
            }
            (Bounds::Factors(lower, upper) | Bounds::Values(lower, upper), _) => return Err(wrong(lower, upper)),
        };
        if lower.is_nan() || upper.is_nan() || lower >= upper {
            let (Bounds::Factors(lower, upper) | Bounds::Values(lower, upper)) = free.bounds else {
                return Err(FitFault::Outside { symbol: first, value: values[0] });
            };
            return Err(wrong(lower, upper));
        }
        if !(lower <= 0.0 && upper >= 0.0) {
            return Err(FitFault::Outside { symbol: first, value: values[0] });
        }
        Ok(Coordinate { symbols: free.symbols.clone(), start: values, scale, lower, upper })
    }

    /// The value of each symbol where the coordinate is `at`.
    pub(super) fn values(&self, at: f64) -> Vec<f64> {
        match self.scale {
            None => {
                let factor = libm::exp(at);
                self.start.iter().map(|start| start * factor).collect()
            }
            // At its bounds 0 and 1 a share may not leave them by rounding.
            Some(scale) => {
                let value = self.start[0] + scale * at;
                vec![if matches!(self.symbols[0], Symbol::LoadShare(_)) { value.max(0.0) } else { value }]
            }
        }
    }

    /// How fast each symbol changes with the coordinate.
    pub(super) fn speeds(&self, at: f64) -> Vec<f64> {
        match self.scale {
            None => self.values(at),
            Some(scale) => vec![scale],
        }
    }

    /// Its symbols in words.
    pub(super) fn name(&self) -> String {
        self.symbols.iter().map(Symbol::to_string).collect::<Vec<_>>().join(" = ")
    }
}

pub(super) const TENFOLD: f64 = std::f64::consts::LN_10;
