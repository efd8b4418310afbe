//! `lunula ui`: the pages of lunula in this machine's browser.

use std::net::{IpAddr, Ipv4Addr};
use std::path::PathBuf;
use std::process::{Command, Stdio};
use std::sync::atomic::AtomicBool;

use anyhow::Context;
use clap::Args;
use lunula_ui::{Server, Settings, Site, UiError};
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
    #[command(flatten)]
    listening: Listening,
    #[command(flatten)]
    common: Common,
}

/// Where a page is.
#[derive(Debug, Args)]
pub(crate) struct Listening {
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
}

/// Where the page of a job at work is, and what else is there.
#[derive(Debug, Args)]
pub(crate) struct PageArgs {
    /// Also show the results below this folder, as `lunula ui` does, on the same port
    #[arg(long, value_name = "DIR", num_args = 1..)]
    results: Vec<PathBuf>,
    #[command(flatten)]
    pub(crate) listening: Listening,
}

impl PageArgs {
    /// A server that listens, with what `sites` have to show, the first of them first.
    pub(crate) fn bind(&self, mut sites: Vec<Site>) -> Result<Server, UiError> {
        if !self.results.is_empty() {
            sites.push(lunula_ui::results(&self.results)?);
        }
        self.listening.bind(sites)
    }
}

pub(super) fn run(args: &UiArgs) -> anyhow::Result<Outcome> {
    let stop = args.common.start()?;
    let server = args.listening.bind(vec![lunula_ui::results(&args.folders)?])?;
    args.listening.serve(server, &args.common, &stop)?;
    Ok(Outcome::Done)
}

impl Listening {
    fn bind(&self, sites: Vec<Site>) -> Result<Server, UiError> {
        let address = self.listen.unwrap_or(Ipv4Addr::LOCALHOST.into());
        let server = Server::bind(&Settings { address, port: self.port, names: self.allow_host.clone() }, sites)?;
        if !address.is_loopback() {
            eprintln!("warning: others can reach {address}, and nothing is encrypted; `ssh -L` is safer");
        }
        Ok(server)
    }

    /// Prints the address, opens it where that is wanted, and serves until `stop`.
    pub(crate) fn serve(&self, server: Server, common: &Common, stop: &AtomicBool) -> anyhow::Result<()> {
        let _opened = self.announce(&server, common)?;
        Ok(server.run(stop)?)
    }

    /// Prints the address, and opens it where that is wanted: by a file, which is there while it is not dropped.
    pub(crate) fn announce(&self, server: &Server, common: &Common) -> anyhow::Result<Option<impl Sized + use<>>> {
        let url = server.url();
        out::print_line(&if common.json { json!({ "url": url }).to_string() } else { url });
        out::finish().context("standard output: cannot be written; make room, or send it elsewhere")?;
        self.opened(server)
    }

    /// Opens the page where that is wanted: by a file, which is there while it is not dropped.
    pub(crate) fn opened(&self, server: &Server) -> anyhow::Result<Option<impl Sized + use<>>> {
        let page = self.open.then(|| server.page_to_open()).transpose();
        let page = page.context("no file can be made for the browser")?;
        if let Some(page) = &page {
            let opened = Command::new("xdg-open").arg(page.path()).stdout(Stdio::null()).stderr(Stdio::null()).spawn();
            if let Err(why) = opened {
                eprintln!(
                    "warning: xdg-open, which opens the browser, can't be run ({why}); open the address yourself"
                );
            }
        }
        Ok(page)
    }
}
