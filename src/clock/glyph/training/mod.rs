//! Where the weights come from: digits drawn with many typefaces and as seven segments, and what is no digit; no
//! photographs.
//!
//! `LUNULA_FONTS=FOLDER cargo test --release --lib glyph::training::train -- --ignored --nocapture` rewrites
//! `weights/digits.txt` (12 minutes of 4 cores), `figures` measures what they are worth. Without the folder, only the
//! two typefaces that come along and the displays train. The folder held Debian 12's packages of the name `fonts-`:
//! 3270, adf-gillius, adf-switzera, adf-universalis, adf-verana, agave, anonymous-pro, arundina, b612, cabin,
//! cantarell, comfortaa, courier-prime, croscore, crosextra-caladea, crosextra-carlito, dejavu-core, dejavu-extra,
//! dosis, dseg, ebgaramond, ecolier-court, fantasque-sans, fanwood, firacode, freefont-ttf, georgewilliams,
//! gfs-neohellenic, go, hack, hermit, hosny-amiri, inconsolata, inter, jetbrains-mono, junction, jura, karla, lato,
//! league-mono, liberation, linuxlibertine, lobster, manchufont, monofur, monoid, mononoki, mplus, national-park,
//! noto-core, noto-mono, ocr-a, oldstandard, open-sans, oxygen, paratype, play, powerline, prociono, quicksand,
//! recommended, roboto-unhinted, sil-andika, symbola, terminus-otb, texgyre, thai-tlwg, tomsontalks, unikurdweb,
//! urw-base35, vlgothic, vollkorn, wine, yanone-kaffeesatz. [`faces`] leaves out what has no ten digits of one height,
//! and holds some families out.

#![allow(clippy::unwrap_used, reason = "a test fails by panicking")]

mod checks;
mod faces;
mod fit;
mod flaws;
mod mask;
mod scene;
mod segments;

use std::fmt::Write as _;
use std::path::Path;

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;

use super::net::{Net, PARTS};
use super::patch::{HEIGHT, WIDTH};
use super::scores::Scores;
use faces::Faces;
use scene::{Kind, OTHER, Sample, samples};

fn draw(faces: &Faces, kind: Kind, number: u64) -> Sample {
    samples(faces, kind, 1, &mut ChaCha8Rng::seed_from_u64(number)).swap_remove(0)
}

fn folder() -> std::path::PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("src/clock/glyph/weights")
}

/// Confidences at which outcomes are counted.
const LEVELS: [f64; 5] = [0.8, 0.9, 0.95, 0.98, 0.99];

/// What comes of samples.
#[derive(Debug, Default)]
struct Outcome {
    count: usize,
    /// Read right and read wrong (others as digits, too) at each of [`LEVELS`].
    right: [usize; LEVELS.len()],
    wrong: [usize; LEVELS.len()],
    /// How often the likeliest digit is at least 0.5 probable and how often it is right then; the sum of its
    /// probability.
    answered: [usize; 2],
    promised: f64,
    /// Sum of the logarithmic loss.
    loss: f64,
}

fn judge(net: &Net, faces: &Faces, kind: Kind, from: u64, count: u64) -> Outcome {
    let each: Vec<(usize, Scores)> = (from..from + count)
        .into_par_iter()
        .map(|k| {
            let s = draw(faces, kind, k);
            (s.label, Scores::of(net.answers(&s.patch)))
        })
        .collect();
    let mut outcome = Outcome { count: each.len(), ..Outcome::default() };
    for (label, scores) in each {
        outcome.loss -= if label == OTHER { scores.other } else { scores.digits[label] }.max(1e-12).ln();
        let (digit, probability) = scores.likeliest();
        let right = usize::from(digit) == label;
        if probability >= 0.5 {
            outcome.answered[0] += 1;
            outcome.answered[1] += usize::from(right);
            outcome.promised += probability;
        }
        for (k, _) in LEVELS.iter().enumerate().filter(|(_, level)| probability >= **level) {
            if right { outcome.right[k] += 1 } else { outcome.wrong[k] += 1 }
        }
    }
    outcome
}

fn number(name: &str, otherwise: u64) -> u64 {
    std::env::var(name).ok().and_then(|n| n.parse().ok()).unwrap_or(otherwise)
}

#[test]
#[ignore = "rewrites the weights; takes an hour of one core"]
fn train() {
    let (known, held_out) = (Faces::load(false), Faces::load(true));
    for faces in [&known, &held_out] {
        let names: Vec<_> = faces.families.iter().map(|f| format!("{} {}", f[0].family, f.len())).collect();
        eprintln!("{} families: {}", names.len(), names.join(", "));
    }
    let steps = number("LUNULA_STEPS", 16_000) as usize;
    let net = fit::fit(
        steps,
        1,
        |k| samples(&known, Kind::Any, 2, &mut ChaCha8Rng::seed_from_u64(k)),
        |step, loss, net| {
            let any = judge(net, &held_out, Kind::Any, 1 << 50, 4000);
            eprintln!(
                "{step}: loss {loss:.4}; held out {:.4}, {} right {} wrong",
                any.loss / any.count as f64,
                any.right[3],
                any.wrong[3]
            );
            if step % 1000 == 0 {
                save(net);
            }
        },
    );
    save(&net);
}

#[test]
#[ignore = "the figures of the weights that stand on LUNULA_COUNT samples of each kind, typefaces held out"]
fn figures() {
    let faces = Faces::load(true);
    for kind in [Kind::Clean, Kind::Digits, Kind::Others, Kind::Any] {
        let outcome = judge(&super::NET, &faces, kind, 1 << 51, number("LUNULA_COUNT", 20_000));
        let shares = |counts: [usize; LEVELS.len()]| counts.map(|n| n as f64 / outcome.count as f64);
        let [answered, right] = outcome.answered;
        eprintln!(
            "{kind:?} {}: at {LEVELS:?} read {:.4?}, wrong {:?} {:.6?}; promised {:.4}, kept {:.4}",
            outcome.count,
            shares(outcome.right),
            outcome.wrong,
            shares(outcome.wrong),
            outcome.promised / answered as f64,
            right as f64 / answered as f64,
        );
    }
}

fn save(net: &Net) {
    let mut text = String::new();
    let mut rest = &net.weights[..];
    for count in PARTS {
        let (part, after) = rest.split_at(count);
        for line in part.chunks(16) {
            let numbers: Vec<String> = line.iter().map(|w| format!("{w:.3}")).collect();
            writeln!(text, "{}", numbers.join(" ")).unwrap();
        }
        rest = after;
    }
    std::fs::write(folder().join("digits.txt"), text).unwrap();
}

#[test]
#[ignore = "draws a sheet of samples to look at, to the file named by LUNULA_SHEET"]
fn show() {
    let faces = Faces::load(number("LUNULA_HELD_OUT", 0) == 1);
    let path = std::env::var("LUNULA_SHEET").unwrap();
    let (columns, scale) = (30usize, 3usize);
    let (wide, tall) = (WIDTH * scale + 4, HEIGHT * scale + 4);
    let mut sheet = image::GrayImage::from_pixel((columns * wide) as u32, (24 * tall) as u32, image::Luma([90]));
    for row in 0..24usize {
        let kind = [Kind::Clean, Kind::Digits, Kind::Others][row / 8];
        for column in 0..columns {
            let s = draw(&faces, kind, (row * columns + column) as u64);
            for y in 0..HEIGHT * scale {
                for x in 0..WIDTH * scale {
                    let ink = s.patch.ink()[y / scale * WIDTH + x / scale];
                    let value = ((ink + 0.3) / 1.6 * 255.0) as u8;
                    sheet.put_pixel((column * wide + x) as u32, (row * tall + y) as u32, image::Luma([value]));
                }
            }
        }
    }
    sheet.save(path).unwrap();
}
