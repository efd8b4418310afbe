//! `digits`: makes and judges the weights that read filmed clocks.

use std::path::{Path, PathBuf};

use anyhow::Context;
use clap::{Parser, Subcommand};
use lunula_training::digits::{Faces, figures, sheet, text, train};

/// Make or judge the weights that read the digits of filmed clocks
///
/// Everything is drawn: typefaces, seven-segment displays, and what is no digit. The weights that lunula comes with
/// (src/clock/glyph/weights/digits.txt) are those of `digits train` with 16 000 steps and, in --fonts, the packages of
/// Debian 12 whose names begin with fonts-: 3270, adf-gillius, adf-switzera, adf-universalis, adf-verana, agave,
/// anonymous-pro, arundina, b612, cabin, cantarell, comfortaa, courier-prime, croscore, crosextra-caladea,
/// crosextra-carlito, dejavu-core, dejavu-extra, dosis, dseg, ebgaramond, ecolier-court, fantasque-sans, fanwood,
/// firacode, freefont-ttf, georgewilliams, gfs-neohellenic, go, hack, hermit, hosny-amiri, inconsolata, inter,
/// jetbrains-mono, junction, jura, karla, lato, league-mono, liberation, linuxlibertine, lobster, manchufont, monofur,
/// monoid, mononoki, mplus, national-park, noto-core, noto-mono, ocr-a, oldstandard, open-sans, oxygen, paratype, play,
/// powerline, prociono, quicksand, recommended, roboto-unhinted, sil-andika, symbola, terminus-otb, texgyre,
/// thai-tlwg, tomsontalks, unikurdweb, urw-base35, vlgothic, vollkorn, wine, yanone-kaffeesatz. What has no ten digits
/// of one height is left out, and ten families are held out. The same folder, steps and kind of processor give the
/// same weights.
#[derive(Debug, Parser)]
#[command(version, max_term_width = 100)]
struct Arguments {
    /// Folder of .ttf and .otf files; without it two typefaces that come along train, and none is held out
    #[arg(long, value_name = "FOLDER", global = true)]
    fonts: Option<PathBuf>,
    #[command(subcommand)]
    job: Job,
}

#[derive(Debug, Subcommand)]
enum Job {
    /// Fit a network by Adam (seed 1, batches of 160 characters, each cut out twice) and write its weights
    ///
    /// 16 000 steps take 12 minutes of 4 cores in a release build. Each thousand steps the loss on held-out typefaces
    /// is printed and the weights so far are written.
    Train {
        /// Batches
        #[arg(long, default_value_t = 16_000)]
        steps: usize,
        /// File for the weights
        #[arg(long)]
        out: PathBuf,
    },
    /// Print what the weights that lunula comes with are worth on held-out typefaces and displays
    ///
    /// A line for each kind: how many are read, how many of these wrong, and whether confidences are kept.
    Figures {
        /// Samples of each kind
        #[arg(long, default_value_t = 20_000, value_parser = clap::value_parser!(u64).range(1..))]
        count: u64,
    },
    /// Draw a sheet of samples to look at
    Sheet {
        /// Draw the held-out typefaces and displays
        #[arg(long)]
        held_out: bool,
        /// File for the picture, such as sheet.png
        #[arg(long)]
        out: PathBuf,
    },
}

fn main() -> anyhow::Result<()> {
    let Arguments { fonts, job } = Arguments::parse();
    let faces = |held_out: bool| Faces::load(fonts.as_deref(), held_out);
    match job {
        Job::Train { steps, out } => {
            let (known, held_out) = (faces(false)?, faces(true)?);
            for faces in [&known, &held_out] {
                let names: Vec<_> = faces.families.iter().map(|f| format!("{} {}", f[0].family, f.len())).collect();
                eprintln!("{} families: {}", names.len(), names.join(", "));
            }
            let net = train(&known, &held_out, steps, |step, loss, net, worth| {
                let held_out = worth.loss / worth.count as f64;
                let [right, wrong] = [worth.right[3], worth.wrong[3]];
                eprintln!("{step}: loss {loss:.4}; held out {held_out:.4}, {right} right {wrong} wrong");
                if let Err(why) = write(&out, &text(net)) {
                    eprintln!("{why:#}");
                }
            });
            write(&out, &text(&net))
        }
        Job::Figures { count } => {
            figures(&faces(true)?, count).iter().for_each(|line| println!("{line}"));
            Ok(())
        }
        Job::Sheet { held_out, out } => sheet(&faces(held_out)?).save(&out).with_context(|| out.display().to_string()),
    }
}

fn write(path: &Path, text: &str) -> anyhow::Result<()> {
    std::fs::write(path, text).with_context(|| path.display().to_string())
}
