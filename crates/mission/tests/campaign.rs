//! Campaigns: what is run, in which order, and how rows become paired columns.

mod small;

use proptest::prelude::*;
use wisdom_belief::Rule;
use wisdom_goals::Policy;
use wisdom_mission::statistics::paired_difference;
use wisdom_mission::{
    CampaignError, MAX_RUNS, METRICS, Memory, Mission, Override, Plan, Row, RowResult, run, table,
};

fn rules() -> Vec<Rule> {
    ["dsmc", "pcr6"].map(|name| name.parse().expect("a rule")).to_vec()
}

fn policies() -> Vec<Policy> {
    ["most-interesting", "expected-interest"].map(|name| name.parse().expect("a policy")).to_vec()
}

proptest! {
    /// Every run has its number, and more seeds behind the others leave the numbers as they are.
    #[test]
    fn added_seeds_leave_the_numbers_of_the_others(few in 1usize..20, more in 0usize..20) {
        let seeds = |count: usize| (0..count).map(|n| 7 + 3 * n as u64).collect::<Vec<_>>();
        let plan = Plan::new(seeds(few), &rules(), &policies()).expect("a plan");
        let longer = Plan::new(seeds(few + more), &rules(), &policies()).expect("a plan");
        prop_assert_eq!(plan.cases().count(), few * 4);
        for (index, case) in plan.cases().enumerate() {
            prop_assert_eq!(case.index, index);
            prop_assert_eq!(longer.case(index), Some(case));
            prop_assert_eq!(case.seed, seeds(few)[index / 4]);
            prop_assert_eq!(case.variant.rule, rules()[index / 2 % 2]);
            prop_assert_eq!(case.variant.policy, policies()[index % 2]);
        }
        prop_assert_eq!(plan.case(few * 4), None);
    }
}

#[test]
fn what_cannot_be_planned_is_refused_by_name() {
    let error = |seeds: Vec<u64>, rules: Vec<Rule>| {
        Plan::new(seeds, &rules, &policies()).expect_err("it is no plan").to_string()
    };
    assert_eq!(error(vec![], rules()), "no seeds; a campaign needs at least one");
    assert_eq!(error(vec![1], vec![]), "no rules; a campaign needs at least one");
    assert_eq!(error(vec![1, 2, 1], rules()), "seed 1 is given twice; a campaign runs each once");
    let twice = [rules(), rules()].concat();
    assert_eq!(error(vec![1], twice), "rule dsmc is given twice; a campaign runs each once");
    assert!(error(vec![u64::MAX], rules()).contains("18446744073709551615; expected at most"));
    let many = (0..=MAX_RUNS as u64 / 4).collect();
    assert!(matches!(
        Plan::new(many, &rules(), &policies()),
        Err(CampaignError::TooMany { rules: 2, policies: 2, .. })
    ));
}

#[test]
fn a_row_tells_what_the_run_came_to_and_reads_back_as_it_was() {
    let case =
        Plan::new(vec![5], &rules(), &policies()).expect("a plan").case(2).expect("one of 4");
    let mut changes = case.overrides().to_vec();
    changes.push(Override::new("budget.time-s", "7200"));
    changes.push(Override::new("goals.expansions", "1000"));
    let mission = Mission::load(&small::shipped("paper"), &changes).expect("a mission");
    assert_eq!(mission.seed, 5);
    assert_eq!(mission.spec.fusion.rule, rules()[1]);
    assert_eq!(mission.spec.policy, policies()[0]);

    let summary = run(&mission, &mut Memory::default(), &mut |_| true).expect("the run ends well");
    assert!(!summary.legs.is_empty(), "it drove");
    let row = Row::finished(&case, &summary);
    assert!(row.is_of(&case));
    let numbers = row.run().expect("it finished");
    assert_eq!(numbers.status, summary.status.to_string());
    assert_eq!(numbers.goals.len(), summary.achieved.len());
    assert_eq!(numbers.interest(), summary.interest());
    assert_eq!(numbers.ruler(), summary.ruler());
    assert_eq!(numbers.brier(), summary.brier());
    assert_eq!(numbers.reliability, summary.reliability());
    assert_eq!(numbers.legs.len(), summary.legs.len());

    let text = toml::to_string(&row).expect("a row is plain");
    assert_eq!(toml::from_str::<Row>(&text).expect("it reads back"), row);
    assert!(row.is_unchanged());
    let mut edited = row.clone();
    let RowResult::Finished(numbers) = &mut edited.result else { panic!("it finished") };
    numbers.distance_m = numbers.distance_m.next_up();
    assert!(!edited.is_unchanged(), "the last bit of a number counts");
    let other = Row { version: row.version + 1, ..row.clone() };
    assert!(!other.is_of(&case), "another version is another row");
}

#[test]
fn a_row_edited_in_any_of_its_parts_no_longer_fits_its_digest() {
    let plan = Plan::new(vec![1, 2], &rules(), &policies()).expect("a plan");
    let case = plan.case(1).expect("one of 8");
    let made = Row::failed(&case, "no ground".into());
    assert!(made.is_unchanged());
    let text = toml::to_string(&made).expect("a row is plain");
    assert!(toml::from_str::<Row>(&text).expect("it reads back").is_unchanged());
    let edited = [
        Row { version: made.version + 1, ..made.clone() },
        Row { index: 2, ..made.clone() },
        Row { seed: 2, ..made.clone() },
        Row { rule: "pcr6".into(), ..made.clone() },
        Row { policy: "most-interesting".into(), ..made.clone() },
        Row { result: RowResult::Failed { error: "no grounds".into() }, ..made.clone() },
        Row { result: row(&plan, 1).result, ..made.clone() },
        Row { digest: String::new(), ..made.clone() },
    ];
    for row in edited {
        assert!(!row.is_unchanged(), "{row:?}");
    }
}

/// A row whose numbers follow from its place.
fn row(plan: &Plan, index: usize) -> Row {
    let case = plan.case(index).expect("a run of the plan");
    let mut row = Row::failed(&case, String::new());
    let text = format!(
        "status = \"waiting\"\ndecisions = {index}\nobservations = 1\ndistance_m = {0}.5\ntime_s = 1.0\n\
         energy_j = 1.0\ndata_mb = 1.0\nreliability = 0.5\nreallocations = 0\nadded = 0\nmodified = 0\n\
         reordered = 0\ndropped = 0\ngoals = []\nlegs = []\nfaults = []\n",
        index * index
    );
    row.result = RowResult::Finished(Box::new(toml::from_str(&text).expect("numbers of a run")));
    row
}

#[test]
fn columns_are_paired_by_seed_whatever_the_order_of_the_rows() {
    let plan = Plan::new(vec![10, 20, 30, 40], &rules(), &policies()[..1]).expect("a plan");
    // Backwards; seed 20 lacks its second run, and one run of seed 40 failed.
    let mut rows: Vec<Row> =
        (0..8).rev().filter(|index| *index != 3).map(|index| row(&plan, index)).collect();
    let failing = plan.case(6).expect("a run of seed 40");
    *rows.iter_mut().find(|row| row.index == 6).expect("it is there") =
        Row::failed(&failing, "no ground".into());

    let paired = table(&plan, &rows);
    assert_eq!(paired.seeds, [10, 30]);
    assert_eq!(paired.left_out, [20, 40]);
    let metric = |name: &str| METRICS.iter().position(|m| m.name == name).expect("a metric");
    let distance = metric("distance_m");
    assert_eq!(paired.values(distance, 0), [0.5, 16.5]);
    assert_eq!(paired.values(distance, 1), [1.5, 25.5]);
    assert_eq!(paired.values(metric("decisions"), 1), [1.0, 5.0]);

    let gain = paired_difference(paired.values(distance, 1), paired.values(distance, 0), 100, 1)
        .expect("two pairs");
    assert_eq!(gain.mean, 5.0);
    assert!(gain.low >= 1.0 && gain.high <= 9.0, "between the two differences: {gain:?}");
}

#[test]
fn rows_of_another_campaign_are_passed_over() {
    let plan = Plan::new(vec![1, 2], &rules(), &policies()).expect("a plan");
    let other = Plan::new(vec![2, 1], &rules(), &policies()).expect("a plan");
    let rows: Vec<Row> = (0..8).map(|index| row(&other, index)).collect();
    assert_eq!(table(&plan, &rows).left_out, [1, 2]);
    assert_eq!(table(&other, &rows).seeds, [2, 1]);
}
