//! shim
use super::*;
/// x
#[derive(Debug, Args)]
pub(super) struct PhantomArgs {}
pub(super) fn run(_: &PhantomArgs) -> anyhow::Result<Outcome> {
    Ok(Outcome::Done)
}
