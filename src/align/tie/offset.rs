//! The offset that the user knows.

use super::{Tie, TieMethod};
use crate::timebase::Timebase;

/// A tie by the offset that the user knows: log time = `offset_s` + video time. `offset_sd_s` is how well, if the user
/// says so; otherwise the standard errors are NaN, which is not known.
///
/// # Errors
/// Numbers that can't be.
pub(crate) fn by_offset(offset_s: f64, offset_sd_s: Option<f64>) -> Result<Tie, String> {
    if !offset_s.is_finite() {
        return Err(format!("the offset is {offset_s} s; it must be a number of seconds: log time less video time"));
    }
    if let Some(sd_s) = offset_sd_s.filter(|sd_s| !(sd_s.is_finite() && *sd_s >= 0.0)) {
        return Err(format!("the offset's standard error is {sd_s} s; it must be a number of seconds, 0 or more"));
    }
    let mut warnings = Vec::new();
    if offset_sd_s.is_none() {
        warnings.push("how well the offset is known was not given: no standard error counts it".to_owned());
    }
    let notes = vec!["the offset is the user's, and drift is taken to be 0".to_owned()];
    let at_reference_sd_s = offset_sd_s.unwrap_or(f64::NAN);
    let timebase = Timebase {
        reference_s: 0.0,
        at_reference_s: offset_s,
        at_reference_sd_s,
        drift: 0.0,
        drift_sd: if offset_sd_s.is_some() { 0.0 } else { f64::NAN },
    };
    Ok(Tie { warnings, notes, ..Tie::of(TieMethod::Offset, timebase) })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_the_user_does_not_say_is_not_known() {
        let tie = by_offset(12.5, None).unwrap();
        assert!(tie.timebase.other_s(2.0) == 14.5 && tie.timebase.offset_sd_s().is_nan());
        assert!(tie.warnings.len() == 1 && tie.notes.len() == 1, "{tie:?}");
        assert_eq!(by_offset(12.5, Some(0.01)).unwrap().timebase.sd_s(100.0), 0.01);
        assert!(by_offset(f64::NAN, None).is_err() && by_offset(1.0, Some(-1.0)).is_err());
    }
}
