//! `lunula ui`: the pages of lunula in this machine's browser.

use std::net::{IpAddr, Ipv4Addr};
use std::path::PathBuf;
use std::process::{Command, Stdio};

use anyhow::Context;
use clap::Args;
use lunula_ui::{Server, Settings};
use serde_json::json;

use crate::{Common, Outcome, out};

/// Look at results in the browser of this machine: runs, their warnings, reports and pictures
///
/// Prints one line, the address of the page with a secret, and serves until it is interrupted. Only this machine can
/// reach it, and only a browser that was given the address; nothing is fetched from elsewhere. From another machine,
/// forward the port: ssh -L PORT:127.0.0.1:PORT MACHINE.
#[derive(Debug, Args)]
pub(super) struct UiArgs {
    /// Folders of results
    #[arg(required = true, value_name = "DIR")]
    folders: Vec<PathBuf>,
    /// The port [default: a free one]
    #[arg(long, default_value_t = 0, hide_default_value = true, value_name = "N")]
    port: u16,
    /// Opens the page in the browser
    #[arg(long)]
    open: bool,
    /// Listens at this address, which others may reach; nothing is encrypted
    #[arg(long, value_name = "ADDRESS", requires = "allow_host")]
    listen: Option<IpAddr>,
    /// What browsers call this machine there: a name or an address
    #[arg(long, value_name = "NAME", requires = "listen")]
    allow_host: Vec<String>,
    #[command(flatten)]
    common: Common,
}

pub(super) fn run(args: &UiArgs) -> anyhow::Result<Outcome> {
    let common = &args.common;
    let stop = common.start()?;
    let settings = Settings {
        folders: args.folders.clone(),
        address: args.listen.unwrap_or(Ipv4Addr::LOCALHOST.into()),
        port: args.port,
        names: args.allow_host.clone(),
    };
    let server = Server::bind(settings)?;
    if let Some(listen) = args.listen.filter(|listen| !listen.is_loopback()) {
        eprintln!("warning: others can reach {listen}, and nothing is encrypted; `ssh -L` is safer");
    }
    let url = server.url();
    out::print_line(&if common.json { json!({ "url": url }).to_string() } else { url });
    out::finish().context("standard output: cannot be written; make room, or send it elsewhere")?;
    // It is there while the page is open.
    let page = args.open.then(|| server.page_to_open()).transpose().context("no file can be made for the browser")?;
    if let Some(page) = &page {
        let opened = Command::new("xdg-open").arg(page.path()).stdout(Stdio::null()).stderr(Stdio::null()).spawn();
        if let Err(why) = opened {
            eprintln!("warning: xdg-open, which opens the browser, can't be run ({why}); open the address yourself");
        }
    }
    server.run(&stop)?;
    Ok(Outcome::Done)
}
