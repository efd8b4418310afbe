//! One drawing written as PNG and SVG, with the typeface, the colours and the legend that all pictures share.

use std::path::Path;
use std::sync::Once;

use anyhow::{Context, anyhow, ensure};
use plotters::coord::Shift;
use plotters::prelude::*;

use super::letters::Bitmap;
use super::text::TYPEFACE;

/// Colours that colour-blind readers can tell apart (Okabe and Ito 2008).
pub(super) const COLOURS: [RGBColor; 6] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(230, 159, 0),
    RGBColor(86, 180, 233),
];

/// A backend of plotters whose errors can be passed on.
pub(super) trait Backend: DrawingBackend<ErrorType: 'static> {}

impl<B: DrawingBackend<ErrorType: 'static>> Backend for B {}

/// What can be drawn with any backend.
pub(super) trait Draw {
    fn draw<B: Backend>(&self, area: &DrawingArea<B, Shift>) -> anyhow::Result<()>;
}

/// Draws on white, `size` pixels wide and high, to `png` and to `svg`.
pub(super) fn write_both(what: &impl Draw, size: (u32, u32), png: &Path, svg: &Path) -> anyhow::Result<()> {
    register_typeface()?;
    let mut pixels = vec![0; (size.0 * size.1 * 3) as usize];
    draw_on_white(what, Bitmap(BitMapBackend::with_buffer(&mut pixels, size)).into_drawing_area())?;
    let picture = image::RgbImage::from_raw(size.0, size.1, pixels).context("a picture's pixels")?;
    // In memory first: what writes to a file by itself passes over the error of its last bytes.
    let mut bytes = Vec::new();
    picture.write_to(&mut std::io::Cursor::new(&mut bytes), image::ImageFormat::Png)?;
    std::fs::write(png, bytes).with_context(|| png.display().to_string())?;
    let mut text = String::new();
    draw_on_white(what, SVGBackend::with_string(&mut text, size).into_drawing_area())?;
    std::fs::write(svg, text).with_context(|| svg.display().to_string())
}

/// Draws the legend of all named series.
pub(super) fn draw_legend<'a, B: Backend + 'a, C: CoordTranslate>(
    chart: &mut ChartContext<'a, B, C>,
    at: SeriesLabelPosition,
) -> anyhow::Result<()> {
    chart
        .configure_series_labels()
        .position(at)
        .background_style(WHITE.mix(0.85))
        .border_style(RGBColor(200, 200, 200))
        .label_font(("sans-serif", 15))
        .draw()
        .map_err(|e| anyhow!("{e}"))
}

fn draw_on_white<B: Backend>(what: &impl Draw, area: DrawingArea<B, Shift>) -> anyhow::Result<()> {
    area.fill(&WHITE).map_err(|e| anyhow!("{e}"))?;
    what.draw(&area)?;
    area.present().map_err(|e| anyhow!("{e}"))
}

/// `0.002`, `3`, `40`: as short as the number allows.
pub(super) fn short_number(value: &f64) -> String {
    let text = format!("{value:.6}");
    let short = text.trim_end_matches('0').trim_end_matches('.');
    if short == "-0" { "0".to_owned() } else { short.to_owned() }
}

pub(super) fn register_typeface() -> anyhow::Result<()> {
    static ONCE: Once = Once::new();
    let mut usable = true;
    ONCE.call_once(|| {
        usable = plotters::style::register_font("sans-serif", FontStyle::Normal, TYPEFACE).is_ok();
    });
    ensure!(usable, "the typeface that is compiled in is damaged");
    Ok(())
}
