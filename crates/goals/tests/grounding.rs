//! Typed objects and operators with parameters become the operators of a domain.

use wisdom_goals::{
    Domain, FactSet, GroundError, GroundFault, GroundPlace, Lifted, MAX_GROUND, ObjectText,
    OperatorPart, OperatorText, SchemaText, ServiceCost, TypeText,
};

fn names(list: &[&str]) -> Vec<String> {
    list.iter().map(ToString::to_string).collect()
}

fn types(list: &[(&str, &str)]) -> Vec<TypeText> {
    let kind = |(name, parent): &(&str, &str)| TypeText {
        name: (*name).into(),
        parent: (!parent.is_empty()).then(|| (*parent).into()),
    };
    list.iter().map(kind).collect()
}

fn objects(list: &[(&str, &str)]) -> Vec<ObjectText> {
    let object =
        |(name, kind): &(&str, &str)| ObjectText { name: (*name).into(), kind: (*kind).into() };
    list.iter().map(object).collect()
}

fn schema(
    name: &str,
    parameters: &[&str],
    [preconditions, adds, deletes]: [&[&str]; 3],
    time_s: f64,
) -> SchemaText {
    SchemaText {
        parameters: names(parameters),
        operator: OperatorText {
            name: name.into(),
            preconditions: names(preconditions),
            adds: names(adds),
            deletes: names(deletes),
            cost: ServiceCost { time_s, ..ServiceCost::default() },
        },
    }
}

/// Two instruments on an arm, a camera on a mast, and a spare that is not mounted.
struct Text {
    types: Vec<TypeText>,
    objects: Vec<ObjectText>,
    facts: Vec<String>,
    operators: Vec<SchemaText>,
}

fn arm() -> Text {
    let i: &[&str] = &["?i - instrument"];
    Text {
        types: types(&[("tool", ""), ("instrument", "tool"), ("camera", "tool")]),
        objects: objects(&[
            ("apxs", "instrument"),
            ("mahli", "instrument"),
            ("spare", "instrument"),
            ("mastcam", "camera"),
        ]),
        facts: names(&["stowed", "mounted(apxs)", "mounted( mahli )", "mounted(mastcam)"]),
        operators: vec![
            schema("drive", &[], [&["stowed"], &[], &[]], 0.0),
            schema("unstow", &[], [&["stowed"], &["out"], &["stowed"]], 120.0),
            schema("stow", &[], [&["out"], &["stowed"], &["out"]], 120.0),
            schema("calibrate", i, [&["out", "mounted(?i)"], &["calibrated(?i)"], &[]], 600.0),
            schema("use", i, [&["out", "calibrated(?i)"], &["used(?i)"], &["idle(?i)"]], 900.0),
            schema("picture", &["?c - camera"], [&["mounted(?c)"], &["seen(?c)"], &[]], 30.0),
        ],
    }
}

impl Text {
    fn lifted(&self) -> Result<Lifted, GroundError> {
        Lifted::new(&self.types, &self.objects, &self.facts, &self.operators)
    }

    fn fault(&self) -> (GroundPlace, String) {
        let error = match self.lifted() {
            Err(error) => error,
            Ok(lifted) => lifted.ground(&[]).expect_err("there is a mistake"),
        };
        (error.place, error.to_string())
    }
}

fn domain(asked: &[&str]) -> Domain {
    let ground = arm().lifted().expect("sound").ground(&names(asked)).expect("few operators");
    Domain::new(&ground.operators, &ground.facts).expect("a domain")
}

#[test]
fn operators_are_grounded_by_type_and_what_cannot_be_is_dropped() {
    let domain = domain(&["used(apxs)", "used(mahli)", "seen(mastcam)"]);
    let operators: Vec<&str> = domain.operators().iter().map(|o| o.name.as_str()).collect();
    // The spare is never mounted; what is mounted stays so and need not be asked.
    assert_eq!(
        operators,
        [
            "drive",
            "unstow",
            "stow",
            "calibrate(apxs)",
            "calibrate(mahli)",
            "use(apxs)",
            "use(mahli)",
            "picture(mastcam)"
        ]
    );
    let facts: Vec<&str> = domain.facts().iter().map(String::as_str).collect();
    assert_eq!(
        facts,
        [
            "stowed",
            "out",
            "calibrated(apxs)",
            "calibrated(mahli)",
            "used(apxs)",
            "used(mahli)",
            "seen(mastcam)"
        ]
    );
    let wanted = domain.set(&names(&["used(mahli)"])).expect("a fact");
    let plan = domain.expand(domain.initial(), wanted).expect("it can be done");
    let told: Vec<&str> = plan.after.iter().map(|&o| domain.operators()[o].name.as_str()).collect();
    assert_eq!(told, ["unstow", "calibrate(mahli)", "use(mahli)"]);
    assert_eq!(plan.cost.time_s, 1620.0);
}

#[test]
fn facts_that_nothing_asks_for_are_dropped() {
    let domain = domain(&["used(apxs)"]);
    assert!(!domain.facts().iter().any(|f| f.starts_with("seen") || f == "used(mahli)"));
    assert!(!domain.operators().iter().any(|o| o.name == "use(mahli)"), "it changes nothing");
}

#[test]
fn a_fact_that_always_holds_can_still_be_asked_for() {
    let domain = domain(&["used(apxs)", "mounted(apxs)"]);
    let mounted = domain.set(&names(&["mounted(apxs)"])).expect("it was asked for");
    assert!(domain.initial().contains(mounted) && mounted != FactSet::EMPTY);
}

#[test]
fn sixty_four_facts_are_those_that_matter() {
    let mut text = arm();
    for i in 0..200 {
        text.objects.push(ObjectText { name: format!("spare-{i}"), kind: "instrument".into() });
    }
    let ground = text.lifted().expect("sound").ground(&names(&["used(apxs)"])).expect("few enough");
    assert!(Domain::new(&ground.operators, &ground.facts).is_ok());
}

#[test]
fn two_parameters_range_over_all_pairs_the_last_one_fastest() {
    let mut text = arm();
    text.operators.push(schema(
        "swap",
        &["?a - instrument", "?c - camera"],
        [&["mounted(?a)"], &["beside(?a, ?c)"], &[]],
        1.0,
    ));
    text.objects.push(ObjectText { name: "hazcam".into(), kind: "camera".into() });
    let asked: Vec<String> = ["apxs", "mahli"]
        .iter()
        .flat_map(|a| ["mastcam", "hazcam"].map(|c| format!("beside({a}, {c})")))
        .collect();
    let ground = text.lifted().expect("sound").ground(&asked).expect("few");
    let swaps: Vec<&str> = ground
        .operators
        .iter()
        .map(|o| o.name.as_str())
        .filter(|name| name.starts_with("swap"))
        .collect();
    assert_eq!(
        swaps,
        [
            "swap(apxs, mastcam)",
            "swap(apxs, hazcam)",
            "swap(mahli, mastcam)",
            "swap(mahli, hazcam)"
        ]
    );
    assert!(ground.schema.iter().filter(|s| **s == 6).count() == 4);
}

#[test]
fn mistakes_are_named_with_their_place() {
    use OperatorPart::{Adds, Parameters, Preconditions};
    let check = |change: &dyn Fn(&mut Text), place: GroundPlace, words: &[&str]| {
        let mut text = arm();
        change(&mut text);
        let (found, said) = text.fault();
        assert_eq!(found, place, "{said}");
        for word in words {
            assert!(said.contains(word), "`{word}` is not said: {said}");
        }
    };
    let at = GroundPlace::Operator;
    check(
        &|t| t.types[1].parent = Some("tol".into()),
        GroundPlace::Parent(1),
        &["`tol` is no type", "there are object, tool, instrument, camera"],
    );
    check(
        &|t| t.types[0].parent = Some("camera".into()),
        GroundPlace::Parent(0),
        &["tool < camera < tool"],
    );
    check(&|t| t.types[2].name = "tool".into(), GroundPlace::Type(2), &["second type", "`tool`"]);
    check(&|t| t.objects[1].name = "apxs".into(), GroundPlace::Object(1), &["second object"]);
    check(&|t| t.objects[1].kind = "lens".into(), GroundPlace::Kind(1), &["`lens` is no type"]);
    check(
        &|t| t.facts[1] = "mounted(apsx)".into(),
        GroundPlace::Fact(1),
        &["`apsx` in `mounted(apsx)` is no object", "apxs, mahli"],
    );
    check(
        &|t| t.facts[1] = "calibrated(mastcam)".into(),
        GroundPlace::Fact(1),
        &["`mastcam` in `calibrated(mastcam)` is of type `camera`; operators have `instrument`"],
    );
    check(
        &|t| t.facts[1] = "mounted(apxs, mahli)".into(),
        GroundPlace::Fact(1),
        &["has 2 arguments; `mounted` has 1"],
    );
    check(&|t| t.facts[1] = "mounted(apxs".into(), GroundPlace::Fact(1), &["expected a fact"]);
    check(
        &|t| t.operators[3].operator.adds[0] = "calibrated(?j)".into(),
        at(3, Adds),
        &["`?j` in `calibrated(?j)` is bound by no parameter; there are ?i"],
    );
    check(
        &|t| t.operators[4].operator.adds[0] = "calibrated".into(),
        at(4, Adds),
        &["`calibrated` has 0 arguments; `calibrated` has 1 elsewhere"],
    );
    check(
        &|t| t.operators[3].parameters[0] = "i - instrument".into(),
        at(3, Parameters),
        &["`i - instrument`", "expected a parameter such as"],
    );
    check(
        &|t| t.operators[3].parameters.push("?k - camera".into()),
        at(3, Parameters),
        &["`?k` is in no fact"],
    );
    check(
        &|t| t.operators[0].parameters.push("?i".into()),
        at(0, Parameters),
        &["`drive` has parameters"],
    );
    check(
        &|t| t.facts.retain(|f| f != "mounted(apxs)" && f != "mounted( mahli )"),
        at(3, Preconditions),
        &["`mounted(apxs)` is never made true"],
    );
    check(
        &|t| t.objects.retain(|o| o.kind != "camera"),
        GroundPlace::Fact(3),
        &["`mastcam` in `mounted(mastcam)` is no object"],
    );
}

#[test]
fn a_type_without_objects_leaves_its_operators_nothing_to_stand_for() {
    let mut text = arm();
    text.objects.retain(|o| o.kind != "camera");
    text.facts.pop();
    let (place, said) = text.fault();
    assert_eq!(place, GroundPlace::Operator(5, OperatorPart::Parameters));
    assert!(said.contains("no object is of type `camera`, for parameter `?c`"), "{said}");
}

#[test]
fn too_many_ground_operators_are_refused_before_they_are_made() {
    let mut text = arm();
    let many = MAX_GROUND + 1 - 13;
    for i in 0..many {
        text.objects.push(ObjectText { name: format!("o{i}"), kind: "tool".into() });
    }
    let place = |text: &Text| text.lifted().expect("sound").ground(&[]).map(|g| g.operators.len());
    assert!(place(&text).is_ok());
    let all: Vec<String> = (0..40).map(|i| format!("?p{i}")).collect();
    let mentions: Vec<String> = all.iter().map(|p| format!("near({p})")).collect();
    let mut huge = schema("huge", &[], [&[], &[], &[]], 0.0);
    huge.parameters = all;
    huge.operator.preconditions = mentions;
    text.operators.push(huge);
    let error = place(&text).expect_err("thousands to the fortieth");
    assert_eq!(error.place, GroundPlace::Operator(6, OperatorPart::Parameters));
    assert!(matches!(error.fault, GroundFault::TooMany { .. }), "{error}");
}
