//! shim
use super::*;
/// x
#[derive(Debug, Args)]
pub(super) struct TradeoffArgs {}
pub(super) fn run(_: &TradeoffArgs) -> anyhow::Result<Outcome> {
    Ok(Outcome::Done)
}
