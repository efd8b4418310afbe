use super::*;

fn parse(text: &str) -> Result<Protocol, String> {
    Protocol::parse(text, FilePath::new("p.toml")).map_err(|why| why.to_string())
}

#[test]
fn the_thesis_protocol_has_its_steps_in_its_order() {
    let protocol = Protocol::thesis();
    let names: Vec<&str> = protocol.steps.iter().map(|step| step.name.as_str()).collect();
    assert_eq!(
        names,
        ["setup", "checks", "practise force", "practise bending", "force", "bending", "force", "bending", "random"]
    );
    let collected: Vec<u32> = protocol.steps.iter().filter(|step| step.collects).map(|step| step.session).collect();
    assert_eq!(collected, [1, 1, 2, 2, 3]);
    let force = protocol.steps[4].motion().unwrap();
    // Equation 21: half of 3 N after a quarter of 180 s.
    let Prompted::Force(at) = force.at(45.0) else { panic!("no force") };
    assert!((at[2] + 1.5).abs() <= 1e-12 && force.whole_s() == 182.0);
    let bending = protocol.steps[5].motion().unwrap();
    assert!(bending.bends() && bending.at(5.0) == Prompted::Bend(75.0) && bending.whole_s() == 60.0);
    assert_eq!((protocol.scale_n(), protocol.steps[1].checks.len()), (3.0, 3));
}

#[test]
fn what_is_left_out_is_the_thesis_and_gauges_stretch_the_scale() {
    let text = "[[step]]\nkind = \"gauge\"\naxis = \"normal\"\n[[step]]\nkind = \"spiral\"\nstarts = \"at once\"\n";
    let protocol = parse(text).unwrap();
    assert_eq!((protocol.space, protocol.scale_n()), (ForceSpace::default(), 4.0));
    assert_eq!(protocol.steps[1].motion().unwrap().seconds, 180.0);
    assert!(!protocol.steps[1].waits && protocol.steps[0].waits && protocol.steps[0].collects);
}

#[test]
fn every_fault_is_named_with_its_line_and_what_to_write() {
    for (text, says) in [
        ("", "p.toml:1: has no step"),
        ("step = 3", "p.toml:1: `step` is no list"),
        ("step = []", "has no step"),
        ("step = [1]", "a step is a table"),
        ("mu = 0\n[[step]]\nkind = \"rest\"", "p.toml:1: mu = 0: choose 0.01 to 10"),
        ("fz_max = 3\n[[step]]\nkind = \"rest\"", "p.toml:1: unknown key `fz_max`; did you mean `fz_max_N`?"),
        ("[[step]]\nseconds = 3", "p.toml:1: this step has no `kind`"),
        ("[[step]]\nkind = \"spirale\"", "p.toml:2: unknown kind of step `spirale`; did you mean `spiral`?"),
        ("[[step]]\nkind = \"ask\"\nseconds = 3", "p.toml:3: unknown key of a step of kind `ask` `seconds`"),
        ("[[step]]\nkind = \"rest\"\nseconds = 1e9", "p.toml:3: seconds = 1000000000: choose 1 to 3600"),
        ("[[step]]\nkind = \"rest\"\nseconds = nan", "p.toml:3: `seconds` has to be a finite number"),
        ("[[step]]\nkind = \"rest\"\nname = \"a,b\"", "p.toml:3: a name is a word"),
        ("[[step]]\nkind = \"rest\"\nsession = 1.5", "p.toml:3: session = 1.5: write a whole number"),
        ("[[step]]\nkind = \"rest\"\nstarts = \"soon\"", "p.toml:3: `starts` is \"space\" or \"at once\""),
        ("[[step]]\nkind = \"ask\"\ncollect = true", "p.toml:3: nothing is collected"),
        ("[[step]]\nkind = \"check\"", "p.toml:1: this step checks nothing"),
        ("[[step]]\nkind = \"check\"\nchecks = [\"adhesion\"]", "p.toml:3: `adhesion` is checked while"),
        ("[[step]]\nkind = \"rest\"\nchecks = [\"tare\"]", "p.toml:3: `tare` is checked in a step of kind"),
        ("[[step]]\nkind = \"rest\"\nchecks = [\"glue\"]", "`glue`: choose photodiodes, tare, sign or adhesion"),
        ("[[step]]\nkind = \"gauge\"", "p.toml:1: axis:"),
        ("[[step]]\nkind = \"gauge\"\naxis = \"lateral\"\nnewtons = 3", "p.toml:4: 3 N of shear slip"),
        ("[[step]]\nkind = \"path\"", "p.toml:1: a path needs `points`"),
        ("[[step]]\nkind = \"path\"\npoints = [[0,0,0,0],[0,0,0,-1]]", "p.toml:3: times of `points`"),
        ("[[step]]\nkind = \"path\"\npoints = [[0,0,0],[2,0,0,-1]]", "p.toml:3: `points` is a list"),
        ("[[step]]\nkind = \"path\"\npoints = [[0,0,0,0],[2,0,0,1]]", "pressing is a negative Fz_N"),
        ("[[step]]\nkind = \"path\"\npoints = [[0,0,0,0],[2,3,4,-1]]", "5 N of shear slip: friction holds 0.75 N"),
        ("[[step]\nkind", "p.toml:1: not TOML"),
    ] {
        let why = parse(text).expect_err(text);
        assert!(why.contains(says), "`{text}` says `{why}`, not `{says}`");
    }
    // All of them at once.
    let why = parse("mu = 0\nx = 1\n[[step]]\nkind = \"rest\"\nseconds = 0\n").unwrap_err();
    assert_eq!(why.lines().count(), 3, "{why}");
    assert!(parse(&"[[step]]\nkind = \"rest\"\n".repeat(201)).unwrap_err().contains("200 are the most"));
}

#[test]
fn a_file_that_is_not_there_or_no_text_is_named() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("p.toml");
    assert!(Protocol::read(&path).unwrap_err().to_string().contains("--write-protocol"));
    std::fs::write(&path, b"\xff\xfe").unwrap();
    assert!(Protocol::read(&path).unwrap_err().to_string().contains("UTF-8"));
    std::fs::write(&path, THESIS).unwrap();
    assert_eq!(Protocol::read(&path).unwrap(), Protocol::thesis());
}
