//! scratch
use std::time::Instant;
use wisdom_mission::*;
fn main() {
    let a: Vec<String> = std::env::args().collect();
    let over: Vec<Override> = a[2..].iter().map(|s| { let (k, v) = s.split_once('=').unwrap(); Override::new(k, v) }).collect();
    let t = Instant::now();
    let m = match Mission::load(std::path::Path::new(&a[1]), &over) { Ok(m) => m, Err(e) => { println!("{e}"); return; } };
    println!("loaded {:?}", t.elapsed());
    let mut mem = Memory::default();
    let mut last = Instant::now();
    let s = run(&m, &mut mem, &mut |p| {
        if let Some(d) = p.decision {
            println!("#{} {:?} t={:.0}/{:.0}s E={:.0}/{:.0} {:.0} m cell {} | {} | open {} left {} exp {} {:?} held {} J {:.3} R {:.3} n {} seen {:.2} bg {:.3}", d.number, last.elapsed(), p.spent.time_s, p.time_s, p.spent.energy_j, p.energy_j, p.spent.length_m, d.state.pose.cell, d.triggers.iter().map(|t| t.to_string()).collect::<Vec<_>>().join(", "), d.verdicts.len(), d.shortlist.left_out.len(), d.expansions, d.proof, d.held, d.plan().sequence.value, d.plan().sequence.reliability, d.plan().sequence.stops.len(), d.seen, d.background);
            println!("    act {} {:?}", d.act.name(), d.plan().sequence.goals().map(|g| g.to_string()).collect::<Vec<_>>());
            for v in &d.verdicts { use wisdom_goals::Action::*; if matches!(v.action, Add|Modify|Reorder|Drop|Achieve) { println!("    {} {} {} {} target {} I {:.3} prize {:.3} dir {} {:?}", v.action, v.goal.id, v.reason, v.cause, v.goal.target, v.goal.interest, v.goal.prize, m.spec.directives[v.goal.directive].name, v.terms.iter().map(|t| format!("{} {:.3} {:?}", t.name, t.value, t.limit)).collect::<Vec<_>>()); } }
        }
        last = Instant::now();
        true
    }).unwrap();
    println!("{:?} {} decisions {} obs, {:?}", s.status, s.decisions, s.observations, t.elapsed());
    println!("achieved {:?}", s.achieved.iter().map(|a| (a.goal.0, a.directive.clone(), a.target, a.interest, a.ruler)).collect::<Vec<_>>());
    println!("{:?} reloc {} brier {:?}", s.actions, s.reallocations(), s.brier());
    println!("{:?}", s.spent);
}
