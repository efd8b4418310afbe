//! The thesis' statements as a whole, and what is refused.

use super::*;

fn thesis() -> Statements {
    Statements::of_the_thesis().unwrap()
}

#[test]
fn the_thesis_statements_are_read_and_each_can_fail() {
    let statements = thesis();
    assert_eq!(statements.all.len(), 141);
    for one in &statements.all {
        assert!(matches!(one.verdict(&Numbers::default()), Verdict::CannotTell(_)), "{}", one.id);
        // Each quantity tried alone at sizes on both sides of any threshold, the others at 1.
        let verdicts: Vec<Verdict> = one
            .names()
            .iter()
            .flat_map(|moved| [-1e3, -1e-4, 1e-4, 1e3].map(|size| (*moved, size)))
            .map(|(moved, size)| {
                let mut numbers = Numbers::default();
                one.names().into_iter().for_each(|name| numbers.set(name, if name == moved { size } else { 1.0 }));
                one.verdict(&numbers)
            })
            .collect();
        assert!(verdicts.contains(&Verdict::DoesNot), "{}: {}", one.id, one.test);
    }
}

#[test]
fn what_fails_fails_whatever_is_missing_of_the_rest() {
    let statements = Statements::read(
        "source = [{ from = 'here', quantities = [['a.x', 'V', 'one'], ['b.y', '', 'other']] }]\n[[statement]]\n\
         id = 'both'\nsection = '1'\nsentence = 'both'\nkind = 'emerges'\n\
         test = [{ quantity = 'a.x', at_most = 1 }, { quantity = '|b.y|', below = 0.5 }]",
    )
    .unwrap();
    let one = &statements.all[0];
    assert_eq!(one.test, "a.x at most 1 V; |b.y| below 0.5");
    let mut numbers = Numbers::default();
    numbers.set("a.x", 2.0);
    assert_eq!(one.verdict(&numbers), Verdict::DoesNot);
    numbers.set("a.x", 1.0);
    assert_eq!(one.verdict(&numbers), Verdict::CannotTell("there are no results of \"b\"".to_owned()));
    numbers.set("b.z", 1.0);
    assert_eq!(one.verdict(&numbers), Verdict::CannotTell("not found: b.y".to_owned()));
    assert_eq!(one.found(&numbers), "a.x 1");
    numbers.set("b.y", -0.4);
    assert_eq!((one.verdict(&numbers), one.found(&numbers)), (Verdict::Agrees, "a.x 1; b.y -0.4".to_owned()));
}

#[test]
fn faults_are_named() {
    let file = |quantities: &str, id: &str, test: &str| {
        format!(
            "source = [{{ from = 'here', quantities = [{quantities}] }}]\n[[statement]]\nid = 'first'\nsection = '1'\n\
             sentence = 's'\nkind = 'put in'\ntest = [{{ quantity = 'a.x', is = 1 }}]\n[[statement]]\nid = '{id}'\n\
             section = '1'\nsentence = 's'\nkind = 'follows'\ntest = [{test}]\n"
        )
    };
    let x = "['a.x', '', 'x']";
    assert!(Statements::read(&file(x, "second", "{ quantity = 'a.x', is = 2 }")).is_ok());
    for (quantities, id, test, named) in [
        (x, "first", "{ quantity = 'a.x', is = 2 }", "first: the name occurs twice"),
        (x, "second", "{ quantity = 'a.x / a.{y,z}', is = 2 }", "second: the quantity a.y, a.z is unknown"),
        (x, "second", "{ quantity = 'a.x', above = 'a.w' }", "second: the quantity a.w is unknown"),
        (x, "second", "{ quantity = 'a.x' }", "second: a.x: there is no threshold"),
        (x, "second", "{ quantity = 'a.x', is = 2, below = 3 }", "second: a.x: below, is are several relations"),
        (x, "second", "{ quantity = 'a.x', at_mots = 2 }", "second: a.x: unknown variant `at_mots`"),
        (x, "second", "{ quantity = 'a.x', below = [] }", "second: a.x: it is compared with nothing"),
        (x, "second", "{ quantity = 'a.x', above = 'a.{}' }", "second: a.{}: {} stands for nothing"),
        (x, "second", "{ is = 2 }", "second: a condition names no `quantity`"),
        (x, "second", "", "second: `test` is empty"),
        ("['a.{x,y}', '', 'x']", "second", "{ quantity = 'a.x', is = 2 }", "a.y: no statement uses this quantity"),
        ("['a.{x,x}', '', 'x']", "second", "{ quantity = 'a.x', is = 2 }", "a.x: the quantity is declared twice"),
    ] {
        let why = Statements::read(&file(quantities, id, test)).unwrap_err().to_string();
        assert!(why.contains(named), "{named}: {why}");
    }
    assert!(Statements::read(&file(x, "second", "").replace("kind", "kin")).is_err());
}
