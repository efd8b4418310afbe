//! Who looks at a session of one finger as it goes, and says which of its rows are recorded: the prompter.

use lunula_live::source::{Condition, HostClock, Rows};
use lunula_live::wire::Row;

use super::error::LiveError;
use super::session::StreamColumns;
use super::view::View;

/// Hears all that happens; called in the session's own thread, so that no call may wait.
pub(crate) trait Onlooker {
    /// The sensor's columns are known, and whether a second device gives the forces.
    ///
    /// # Errors
    /// Columns that lack.
    fn begin(&mut self, columns: &StreamColumns, joins_forces: bool) -> Result<(), LiveError>;

    /// The force transducer's columns are known.
    ///
    /// # Errors
    /// Columns that lack.
    fn join(&mut self, names: &[String]) -> Result<(), LiveError>;

    /// A sample, at `common_s` of the clock that all sources are on. Where it is recorded, the time to record it at,
    /// and further cells, each behind a comma, in `cells`.
    fn sample(&mut self, row: &Row<'_>, common_s: f64, cells: &mut String) -> Option<f64>;

    /// A sample of the force transducer, at `common_s`.
    fn force(&mut self, row: &Row<'_>, common_s: f64);

    /// What a row that is recorded says of the three forces, newtons; NaN where not known.
    fn recorded(&mut self, force_n: [f64; 3]);

    /// How a source is now.
    fn state(&mut self, is_force: bool, condition: Condition);

    /// Time has passed: nanoseconds of the host's clock.
    fn tick(&mut self, now_ns: u64) -> Result<(), LiveError>;

    /// Whether nothing more is wanted of the session.
    fn is_over(&self) -> bool;
}

/// A session that is looked at.
pub(crate) struct Attended<'a> {
    pub(crate) onlooker: &'a mut dyn Onlooker,
    /// The columns of its further cells.
    pub(crate) columns: &'a [&'a str],
    /// The clock of both.
    pub(crate) clock: HostClock,
    /// Rows that a program makes, in place of opening the source.
    pub(crate) rows: Option<Box<dyn Rows>>,
    /// What is done, for the report.
    pub(crate) job: &'static str,
    /// Where the session leaves what a page shows of the sensor.
    pub(crate) view: Option<View>,
}
