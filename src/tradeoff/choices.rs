//! The jobs; what can be chosen in each, what is chosen unless the user says otherwise, and why: the one place of it.
//! The page states it, the book repeats it, and a test compares the two.

use super::predictor::switch;
use super::{align, hemodynamics, photos, posture, predictor};
use crate::words::instead;

/// What can be measured.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Job {
    /// Photographs to maps.
    Photos,
    /// Video to joint angles.
    Posture,
    /// Angles onto logs.
    Align,
    /// Photodiodes to force.
    Predictor,
    /// Pressure to blood flow.
    Hemodynamics,
    /// Photodiodes to a decision.
    Switch,
}

impl Job {
    /// In the order of the page.
    pub const ALL: [Self; 6] =
        [Self::Photos, Self::Posture, Self::Align, Self::Predictor, Self::Hemodynamics, Self::Switch];

    /// As on the command line.
    #[must_use]
    pub fn name(self) -> &'static str {
        match self {
            Self::Photos => photos::RESAMPLING.0,
            Self::Posture => posture::TRACKING.0,
            Self::Align => align::TYING.0,
            Self::Predictor => predictor::MODEL.0,
            Self::Hemodynamics => hemodynamics::SOLVING.0,
            Self::Switch => switch::MODEL.0,
        }
    }

    /// The job of a name.
    ///
    /// # Errors
    /// Another name, with the nearest that there is.
    pub fn named(name: &str) -> Result<Self, String> {
        let known = Self::ALL.map(Self::name);
        let found = Self::ALL.into_iter().find(|job| job.name() == name);
        found.ok_or_else(|| format!("`{name}` is not a stage; {}", instead(name, &known)))
    }
}

/// Settings of which one is chosen.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Choice {
    /// Of which job.
    pub job: &'static str,
    /// What is chosen.
    pub name: &'static str,
    /// By which option, or where in the library.
    pub option: &'static str,
    /// The default setting, as rows name it; made from the job's own default.
    pub default: String,
    /// How the unit of the deciding error begins; other errors are shown beside it.
    pub judged_by: &'static str,
    /// Why the default is the default, where it is the knee and where it is not.
    pub why: &'static str,
}

/// Every choice, by job.
#[must_use]
pub fn choices() -> Vec<Choice> {
    let choice = |(job, name): (&'static str, &'static str), option, default, judged_by, why| Choice {
        job,
        name,
        option,
        default,
        judged_by,
        why,
    };
    vec![
        choice(
            photos::RESAMPLING,
            "--resample",
            photos::resampling_default(),
            photos::SMALL_PICTURE_ERROR,
            "It is chosen for small nails, where it errs least; on nails of 200 px and more \
             linear errs a little less, and is faster.",
        ),
        choice(
            photos::DETECTION,
            "--detect-size",
            photos::detection_default(),
            photos::OUTLINE_ERROR,
            "It is beyond the knee because the curve is of close-ups, on which 200 px find even more nails; on \
             photographs of whole hands nails are small.",
        ),
        choice(
            posture::TRACKING,
            "library: posture::Method",
            posture::tracking_default(),
            posture::ALL_JOINTS,
            "It is beyond the knee because less of it saves little: the whole job takes 1.14 times as long as \
             only decoding, and rounds end by themselves where nothing is gained.",
        ),
        choice(
            align::TYING,
            "--sync; library: posture::PostureOptions::clock_every",
            align::tying_default(),
            align::TIE_ERROR,
            "It is beyond the knee because reading the clock adds 2 to 4 % to the time of a video, and a clock that \
             stops or jumps is noticed only in frames in which it is read.",
        ),
        choice(
            align::BRIDGING,
            "--max-gap",
            align::bridging_default(),
            align::LABEL_ERROR,
            "Run time does not depend on it. Two frames bridge a marker that is lost in a single one; longer gaps \
             label more rows, and worse.",
        ),
        choice(
            predictor::MODEL,
            "--model, --hidden, --restarts",
            predictor::model_default(),
            predictor::FIT,
            "On random movement no model is better by more than some hundredths of a newton, and which one depends on \
             the person (docs/src/thesis/section-5-4.md).",
        ),
        choice(
            predictor::ROWS,
            "all that are given",
            predictor::rows_default(),
            predictor::ROWS_ERROR,
            "It is beyond the knee because a fit of all rows takes milliseconds, and which rows can be missed is \
             not known beforehand.",
        ),
        choice(
            predictor::SOLVER,
            "library: LeastSquaresOptions",
            predictor::solver_default(),
            predictor::SOLVER_DECIDES,
            "Photodiodes that are nearly alike are what this sensor has; refined, no digit is lost on them, in a \
             millisecond.",
        ),
        choice(
            hemodynamics::SOLVING,
            "--rtol; library: Order",
            hemodynamics::solving_default(),
            hemodynamics::ERROR,
            "It is before the knee because each further digit costs about a fifth more time, and eight are more \
             than any recording has; --rtol 1e-12 is there for whoever compares solvers.",
        ),
        choice(
            switch::MODEL,
            "--model, --column",
            switch::model_default(),
            switch::LOST,
            "A model of contact itself with lags loses least, presses and lets go soonest, and takes no longer to \
             answer; only a model that saw rest as well as presses keeps false switches away.",
        ),
        choice(
            switch::RATE,
            "--false-per-hour",
            switch::rate_default(),
            switch::FALSE,
            "It is beyond the knee because a false switch costs its user more than 40 ms do; in hours without any the \
             error is what their length can show.",
        ),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_choice_is_made_once_and_its_reason_and_default_are_in_the_book() {
        let words = |text: &str| text.split_whitespace().collect::<Vec<_>>().join(" ");
        let page = words(include_str!("../../docs/src/accuracy/defaults.md"));
        let all = choices();
        for (k, choice) in all.iter().enumerate() {
            let of = format!("{}, {}", choice.job, choice.name);
            assert!(page.contains(&words(choice.why)), "the book does not say of {of}: {}", choice.why);
            assert!(page.contains(&choice.default), "the book does not name the default of {of}: {}", choice.default);
            assert!(all[..k].iter().all(|other| (other.job, other.name) != (choice.job, choice.name)), "{of}: twice");
            assert!(choice.why.ends_with('.') && !choice.default.is_empty(), "{of}");
        }
    }
}
