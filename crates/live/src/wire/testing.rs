//! What tests take columns for.

use crate::wire::row::{Meaning, Use};

/// A column's use by its name: `time_us`, `time_s`, `n`, `led`, values that begin with `P` or `F`.
pub(crate) fn naming(names: &[String]) -> Result<Meaning, String> {
    let mut values = 0;
    let mut uses = Vec::new();
    for name in names {
        uses.push(match name.as_str() {
            "time_us" => Use::Time { per_second: 1e6 },
            "time_s" => Use::Time { per_second: 1.0 },
            "n" => Use::Counter,
            "led" => Use::Led,
            name if name.starts_with(['P', 'F']) => {
                values += 1;
                Use::Value { at: values - 1, scaled: name.starts_with('P') }
            }
            _ => Use::None,
        });
    }
    if values == 0 {
        return Err("there is no photodiode; name them P1, P2".to_owned());
    }
    Ok(Meaning { uses, values, texts: 0 })
}
