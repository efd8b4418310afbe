//! Names of free parameters as people write them: `k_C` (all capillaries alike), `k_C1`, `k_V_N_per_m`.

use lunula_hemodynamics::{Parameters, Symbol};

use crate::words::in_order;

/// A symbol without its unit.
fn short(symbol: Symbol) -> String {
    let name = symbol.to_string();
    let unit = match symbol {
        Symbol::Stiffness(_) => "_N_per_m",
        Symbol::Mass(_) => "_kg",
        Symbol::Damping(_) => "_N_s_per_m",
        Symbol::Area(_) => "_m2",
        Symbol::Diameter(_) | Symbol::Length(_) | Symbol::Path(_) => "_m",
        Symbol::Venule(_) => "_Pa_s_per_m3",
        Symbol::Tissue(_) => "_m3",
        Symbol::Offset(_) | Symbol::Scaling(_) => "_V",
        Symbol::Viscosity => "_Pa_s",
        Symbol::Absorption => "_per_m",
        Symbol::Upstream | Symbol::Downstream => "_Pa",
        Symbol::Count(_) | Symbol::LoadShare(_) => "",
    };
    name.strip_suffix(unit).unwrap_or(&name).to_owned()
}

/// A symbol without its unit and without its number: `k_C`, `R_V`, `V0`.
fn family(symbol: Symbol) -> String {
    let name = short(symbol);
    name.trim_end_matches(|c: char| c.is_ascii_digit()).trim_end_matches('_').to_owned()
}

/// The symbols that a name stands for: one, or those of all units, which move together.
pub(super) fn symbols_of(name: &str, parameters: &Parameters) -> Option<Vec<Symbol>> {
    let all = parameters.symbols();
    if let Some(&one) = all.iter().find(|&&symbol| name == symbol.to_string() || name == short(symbol)) {
        return Some(vec![one]);
    }
    let own: Vec<Symbol> =
        all.iter().copied().filter(|&symbol| numbered(symbol)).filter(|&symbol| family(symbol) == name).collect();
    (!own.is_empty()).then_some(own)
}

fn numbered(symbol: Symbol) -> bool {
    short(symbol).ends_with(|c: char| c.is_ascii_digit())
}

/// That names stand for nothing, with those that there are.
pub(super) fn no_such(unknown: &[&str], parameters: &Parameters) -> String {
    let name = |symbol| if numbered(symbol) { family(symbol) } else { short(symbol) };
    let names = in_order(parameters.symbols().into_iter().map(name));
    format!(
        "--free {}: there is no such parameter; there are {} (of all units alike), of a single unit as k_C1, or whole \
         names as k_C1_N_per_m",
        unknown.join(","),
        names.join(", ")
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_stands_for_a_symbol_or_for_those_of_all_units() {
        let parameters = Parameters::thesis();
        let held = |name: &str| -> Vec<String> {
            symbols_of(name, &parameters).unwrap().iter().map(Symbol::to_string).collect()
        };
        assert_eq!(held("k_C"), ["k_C1_N_per_m", "k_C2_N_per_m"]);
        assert_eq!(held("k_C2"), ["k_C2_N_per_m"]);
        assert_eq!(held("b_V_N_s_per_m"), ["b_V_N_s_per_m"]);
        assert_eq!(held("R_V"), ["R_V1_Pa_s_per_m3", "R_V2_Pa_s_per_m3"]);
        assert_eq!(held("V0"), ["V0_1_V", "V0_2_V"]);
        assert_eq!(held("share"), ["share_1", "share_2"]);
        assert_eq!(
            (held("N_V"), held("L_V"), held("P_H")),
            (vec!["N_V".into()], vec!["L_V_m".into()], vec!["P_H_Pa".into()])
        );
    }

    #[test]
    fn every_symbol_has_a_short_name_of_its_own() {
        let parameters = Parameters::along_nail(12).unwrap();
        for symbol in parameters.symbols() {
            assert_eq!(symbols_of(&short(symbol), &parameters), Some(vec![symbol]), "{symbol}");
        }
        assert!(symbols_of("k", &parameters).is_none() && no_such(&["k"], &parameters).contains("k_C, k_V"));
        assert!(symbols_of("", &parameters).is_none());
    }
}
