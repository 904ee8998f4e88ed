//! Logs that somebody changed: every kind is caught, and named by decision, stage and field.
//!
//! A forger here has all the tools: a changed record is written into a sound file again with every checksum, the digest
//! chain, the end record and the mission's digest made anew. Only deriving the run again can tell.

#![expect(clippy::print_stdout, reason = "the test's own output shows how each was caught")]

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use mcap::records::{MessageHeader, Metadata};
use prost::Message as _;
use wisdom_logbook::record::{self, CHAIN_START, Decision};
use wisdom_logbook::{
    Difference, LogReader, MapMode, Options, Status, SyncPolicy, Verification, VerifyLevel, topic,
    verify,
};
use wisdom_mission::{Mission, Override};

/// A message of a log, still encoded.
#[derive(Clone)]
struct Message {
    topic: String,
    schema: Option<(String, String, Vec<u8>)>,
    encoding: String,
    sequence: u32,
    stamp_ns: u64,
    data: Vec<u8>,
}

/// A log taken apart.
#[derive(Clone)]
struct Parts {
    run: BTreeMap<String, String>,
    attachments: Vec<(String, String, Vec<u8>)>,
    messages: Vec<Message>,
    end: BTreeMap<String, String>,
    /// A further metadata record: before the messages if it opens a run, else after the end.
    more: Option<&'static str>,
}

/// What a forger makes anew.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Repair {
    /// Checksums alone.
    Checksums,
    /// The chain and what the end record says of it, too.
    All,
}

impl Parts {
    fn of(path: &Path) -> Self {
        let bytes = fs::read(path).expect("a log");
        let log = LogReader::open(path).expect("a log");
        let messages = mcap::MessageStream::new(&bytes).expect("a container").map(|message| {
            let message = message.expect("a sound message");
            let schema = message.channel.schema.as_ref();
            Message {
                topic: message.channel.topic.clone(),
                schema: schema.map(|s| (s.name.clone(), s.encoding.clone(), s.data.to_vec())),
                encoding: message.channel.message_encoding.clone(),
                sequence: message.sequence,
                stamp_ns: message.log_time,
                data: message.data.to_vec(),
            }
        });
        let end = log.end.expect("the run ended");
        let mut facts = end.facts;
        facts.insert("status".to_owned(), end.status);
        facts.insert("decisions".to_owned(), end.decisions.to_string());
        facts.insert("chain".to_owned(), end.chain);
        Self {
            run: log.metadata,
            attachments: log
                .attachments
                .into_iter()
                .map(|a| (a.name, a.media_type, a.data))
                .collect(),
            messages: messages.collect(),
            end: facts,
            more: None,
        }
    }

    /// Changes the records of one topic.
    fn each<M: prost::Message + Default>(&mut self, topic: &str, mut change: impl FnMut(&mut M)) {
        for message in self.messages.iter_mut().filter(|m| m.topic == topic) {
            let mut record = M::decode(&message.data[..]).expect("a record");
            change(&mut record);
            message.data = record.encode_to_vec();
        }
    }

    fn decision(&mut self, number: u32, change: impl Fn(&mut Decision)) {
        self.each(topic::DECISION, |decision: &mut Decision| {
            if decision.number == number {
                change(decision);
            }
        });
    }

    fn observation(&mut self, number: u32, change: impl Fn(&mut record::Observation)) {
        self.each(topic::OBSERVATION, |observation: &mut record::Observation| {
            if observation.number == number {
                change(observation);
            }
        });
    }

    fn outcome(&mut self, decision: u32, change: impl Fn(&mut record::Outcome)) {
        self.each(topic::OUTCOME, |outcome: &mut record::Outcome| {
            if outcome.decision == decision {
                change(outcome);
            }
        });
    }

    /// Changes the text of the mission inside.
    fn mission(&mut self, from: &str, to: &str) {
        let text = self.attachments.iter_mut().find(|(name, ..)| name == "mission/mission.toml");
        let (_, _, data) = text.expect("the mission is inside");
        let text = String::from_utf8(data.clone()).expect("text");
        assert!(text.contains(from), "no `{from}` in\n{text}");
        *data = text.replacen(from, to, 1).into_bytes();
    }

    /// Everything that follows from the records without driving or deciding.
    fn repair(&mut self) {
        let mut link = CHAIN_START;
        let mut decisions = 0;
        self.each(topic::DECISION, |decision: &mut Decision| {
            link = decision.link(&link);
            decision.chain = hex(&link);
            decisions += 1;
        });
        self.end.insert("chain".to_owned(), hex(&link));
        self.end.insert("decisions".to_owned(), decisions.to_string());
        let files: BTreeMap<String, Vec<u8>> = self
            .attachments
            .iter()
            .filter_map(|(name, _, data)| {
                Some((name.strip_prefix("mission/")?.to_owned(), data.clone()))
            })
            .collect();
        if let Ok(mission) = Mission::from_files(&files) {
            self.run.insert("mission_digest".to_owned(), hex(&mission.digest));
            self.run.insert("seed".to_owned(), mission.seed.to_string());
        }
    }

    fn write(mut self, path: &Path, repair: Repair) {
        if repair == Repair::All {
            self.repair();
        }
        let file = std::io::BufWriter::new(fs::File::create(path).expect("a new file"));
        let mut writer = mcap::Writer::new(file).expect("a container");
        let run = Metadata { name: "wisdom.run".to_owned(), metadata: self.run };
        writer.write_metadata(&run).expect("it fits");
        let more =
            self.more.map(|name| Metadata { name: name.to_owned(), metadata: BTreeMap::new() });
        if let Some(again) = more.as_ref().filter(|more| more.name == "wisdom.run") {
            writer.write_metadata(again).expect("it fits");
        }
        for (name, media_type, data) in &self.attachments {
            writer
                .attach(&mcap::Attachment {
                    log_time: 0,
                    create_time: 0,
                    name: name.clone(),
                    media_type: media_type.clone(),
                    data: Cow::Borrowed(data),
                })
                .expect("it fits");
        }
        let mut channels: BTreeMap<String, u16> = BTreeMap::new();
        for message in &self.messages {
            let channel_id = *channels.entry(message.topic.clone()).or_insert_with(|| {
                let schema = message.schema.as_ref().map_or(0, |(name, encoding, data)| {
                    writer.add_schema(name, encoding, data).expect("it fits")
                });
                let none = BTreeMap::new();
                let encoding = &message.encoding;
                writer.add_channel(schema, &message.topic, encoding, &none).expect("it fits")
            });
            let Message { sequence, stamp_ns, ref data, .. } = *message;
            let header =
                MessageHeader { channel_id, sequence, log_time: stamp_ns, publish_time: stamp_ns };
            writer.write_to_known_channel(&header, data).expect("it fits");
        }
        let end = Metadata { name: "wisdom.end".to_owned(), metadata: self.end };
        writer.write_metadata(&end).expect("it fits");
        if let Some(late) = more.as_ref().filter(|more| more.name != "wisdom.run") {
            writer.write_metadata(late).expect("it fits");
        }
        writer.finish().expect("it is closed");
    }
}

fn hex(bytes: &[u8]) -> String {
    use std::fmt::Write as _;
    bytes.iter().fold(String::new(), |mut text, byte| {
        write!(text, "{byte:02x}").expect("a string takes every text");
        text
    })
}

/// A run of the paper's scene with a command that comes, and goes.
fn sound(folder: &Path) -> PathBuf {
    let place = Path::new(env!("CARGO_MANIFEST_DIR")).join("missions/paper");
    let changes = [
        Override::new("goals.expansions", "2000"),
        Override::new("goals.max-sequenced", "8"),
        Override::new("budget.energy-j", "6e5"),
    ];
    let command = "\n[[command]]\nname = \"go there\"\nat-s = 60.0\ndirective = \"image-site\"\ntarget = [40, 40]\nprize = 2.0\n";
    let mission = Mission::load(&place, &changes).expect("the mission loads");
    let mut files = mission.files.clone();
    files.get_mut("mission.toml").expect("its own file").extend_from_slice(command.as_bytes());
    let mission = Mission::from_files(&files).expect("the mission loads with a command");
    let path = folder.join("sound.mcap");
    let options = Options { sync: SyncPolicy::End, maps: MapMode::Full };
    let mut log = wisdom_logbook::begin(&path, &mission, options).expect("a new log");
    let summary = wisdom_mission::run(&mission, &mut log, &mut |_| true).expect("it runs");
    log.finish(&summary.status.to_string(), &BTreeMap::new()).expect("it is closed")
}

/// How a forgery shows.
#[derive(Debug, Clone, Copy)]
enum Caught {
    /// The file itself does not hold.
    File(&'static str),
    /// The log is not of the mission it names.
    Identity(&'static str),
    /// Deciding again gives something else: at this stage, in a field that holds this.
    Stage(&'static str, &'static str),
    /// Driving again gives something else: in a field that holds this.
    Driven(&'static str),
}

struct Forgery {
    name: &'static str,
    repair: Repair,
    caught: Caught,
    forge: Box<dyn Fn(&mut Parts)>,
}

fn forgery(
    name: &'static str,
    repair: Repair,
    caught: Caught,
    forge: impl Fn(&mut Parts) + 'static,
) -> Forgery {
    Forgery { name, repair, caught, forge: Box::new(forge) }
}

/// What somebody may do to the file with good checksums, but no knowledge of the chain.
fn of_the_file() -> Vec<Forgery> {
    use Caught::{File, Identity};
    use Repair::Checksums;
    let nth = |parts: &Parts, topic: &str, n: usize| {
        let of_topic = parts.messages.iter().enumerate().filter(|(_, m)| m.topic == topic);
        of_topic.map(|(at, _)| at).nth(n).expect("there are so many")
    };
    vec![
        forgery("a decision changed", Checksums, File("does not follow from its chain"), |p| {
            p.decision(1, |d| {
                let frame = d.frame.as_mut().expect("a frame");
                frame.seen = frame.seen.next_up();
            });
        }),
        forgery("a decision left out", Checksums, File("where 0 was due"), move |p| {
            let at = nth(p, topic::DECISION, 1);
            p.messages.remove(at);
        }),
        forgery("two decisions swapped", Checksums, File("where 1 was due"), move |p| {
            let (a, b) = (nth(p, topic::DECISION, 1), nth(p, topic::DECISION, 2));
            p.messages.swap(a, b);
        }),
        forgery("an observation left out", Checksums, File("observation 2 where 1"), move |p| {
            let at = nth(p, topic::OBSERVATION, 1);
            p.messages.remove(at);
        }),
        forgery("an outcome of another decision", Checksums, File("outcome of decision"), |p| {
            p.outcome(1, |o| o.decision = 0);
        }),
        forgery(
            "an end that tells of more decisions",
            Checksums,
            File("the run ended with"),
            |p| {
                p.end.insert("decisions".to_owned(), "99".to_owned());
            },
        ),
        forgery("an end of another chain", Checksums, File("the run ended with"), |p| {
            p.end.insert("chain".to_owned(), "00".repeat(32));
        }),
        forgery("a second map of one decision", Checksums, File("is there twice"), move |p| {
            let at = nth(p, topic::INTEREST, 1);
            let twice = p.messages[at].clone();
            p.messages.insert(at, twice);
        }),
        forgery("a map of another decision", Checksums, File("of decision 5 before 1"), move |p| {
            let at = nth(p, topic::INTEREST, 1);
            p.messages[at].sequence = 5;
        }),
        forgery("a second beginning", Checksums, File("wisdom.run is there twice"), |p| {
            p.more = Some("wisdom.run");
        }),
        forgery("something after the end", Checksums, File("follows the end"), |p| {
            p.more = Some("weather");
        }),
        forgery("another rule named", Checksums, Identity("rule"), |p| {
            p.run.insert("rule".to_owned(), "pcr6".to_owned());
        }),
        forgery("another mission inside", Checksums, Identity("mission_digest"), |p| {
            p.mission("min-prominence = 0.1", "min-prominence = 0.11");
        }),
    ]
}

/// The surest reading of those that are in any doubt: window and index. No later one is surer, so it stays on the map.
fn surest(observation: &record::Observation) -> (usize, usize) {
    let windows = observation.windows.iter().enumerate();
    let readings = windows.flat_map(|(w, window)| {
        window.uncertainty.iter().enumerate().map(move |(at, &u)| (u, w, at))
    });
    let (_, window, at) =
        readings.filter(|r| r.0 > 0.0).min_by(|a, b| a.0.total_cmp(&b.0)).expect("readings");
    (window, at)
}

/// Inputs changed, everything else made to fit: only deciding again, or driving again, can tell.
fn of_inputs() -> Vec<Forgery> {
    use Caught::{Driven, Stage};
    use Repair::All;
    vec![
        forgery("one ulp of one reading", All, Stage("frame", "digest"), |p| {
            p.observation(0, |o| {
                let (window, at) = surest(o);
                let value = &mut o.windows[window].values[at];
                *value = value.next_up();
            });
        }),
        forgery("one ulp of one uncertainty", All, Stage("frame", "digest"), |p| {
            p.observation(0, |o| {
                let (window, at) = surest(o);
                let u = &mut o.windows[window].uncertainty[at];
                *u = u.next_up();
            });
        }),
        forgery("a window moved by a column", All, Stage("frame", "digest"), |p| {
            p.observation(1, |o| o.windows[0].col -= 1);
        }),
        forgery("a layer's window left out", All, Stage("frame", ""), |p| {
            p.observation(1, |o| {
                o.windows.pop();
            });
        }),
        forgery("another pose observed", All, Stage("state", "pose"), |p| {
            p.observation(1, |o| {
                let cell = o.pose.as_mut().and_then(|p| p.cell.as_mut()).expect("a pose");
                cell.col += 1;
            });
        }),
        forgery("a joule less spent", All, Stage("state", "spent.energy_j"), |p| {
            p.outcome(0, |o| o.spent.as_mut().expect("spent").energy_j -= 1.0);
        }),
        forgery("a second won back", All, Stage("state", "spent.time_s"), |p| {
            p.outcome(1, |o| o.spent.as_mut().expect("spent").time_s -= 1.0);
        }),
        forgery("a failure told as a success", All, Stage("state", "events"), |p| {
            p.outcome(0, |o| {
                let achieved = o.result == "achieved";
                o.result = String::from(if achieved { "aborted" } else { "achieved" });
            });
        }),
        forgery("a command worth more", All, Stage("state", "commands"), |p| {
            p.each(topic::MESSAGE, |m: &mut record::Message| m.prize = Some(2.5));
        }),
        forgery("a command left out", All, Stage("", ""), |p| {
            p.messages.retain(|m| m.topic != topic::MESSAGE);
        }),
        forgery("another weight in the mission", All, Stage("", ""), |p| {
            p.mission("weight = 1.0", "weight = 1.01");
        }),
        forgery("a larger purse in the mission", All, Stage("", ""), |p| {
            p.mission("energy-j = 6e5", "energy-j = 6.5e5");
        }),
        forgery("a reliability told wrong", All, Driven("predicted_reliability"), |p| {
            p.outcome(0, |o| o.predicted_reliability = 0.5);
        }),
        forgery("another seed", All, Driven("observation"), |p| {
            p.mission("seed = 1", "seed = 2");
        }),
        forgery("a camera that sees less well", All, Driven("observation"), |p| {
            p.mission("u0 = 0.05", "u0 = 0.06");
        }),
    ]
}

/// Outputs changed, and the chain made to fit.
fn of_outputs() -> Vec<Forgery> {
    use Caught::Stage;
    use Repair::All;
    fn choice(d: &mut Decision) -> &mut record::Choice {
        d.choice.as_mut().expect("a choice")
    }
    vec![
        forgery("another plan said to be chosen", All, Stage("choice", "chosen"), |p| {
            p.decision(1, |d| choice(d).chosen += 1);
        }),
        forgery("another reason", All, Stage("choice", "reason"), |p| {
            p.decision(1, |d| choice(d).verdicts[0].reason = String::from("energy"));
        }),
        forgery("a number behind a reason", All, Stage("choice", "terms"), |p| {
            p.decision(1, |d| {
                let verdicts = &mut choice(d).verdicts;
                let term = verdicts.iter_mut().flat_map(|v| &mut v.terms).next().expect("a number");
                term.value = term.value.map(f64::next_up);
            });
        }),
        forgery("a failed try forgotten", All, Stage("choice", "attempts"), |p| {
            p.decision(1, |d| {
                choice(d).manager.as_mut().expect("a memory").goals[0].attempts += 1;
            });
        }),
        forgery("a step in a life that may not be", All, Stage("choice", "transitions"), |p| {
            p.decision(0, |d| choice(d).transitions[0].to = String::from("finished"));
        }),
        forgery("a waypoint beside the way", All, Stage("choice", "plan.legs"), |p| {
            p.decision(0, |d| {
                let plan = choice(d).plan.as_mut().expect("a plan");
                let cells = &mut plan.legs[0].route.as_mut().expect("a way").cells;
                let middle = cells.len() / 2;
                cells[middle].row += 1;
            });
        }),
        forgery("a reason to decide left out", All, Stage("trigger", "triggers"), |p| {
            p.decision(1, |d| d.triggers.clear());
        }),
        forgery("a plan worth more", All, Stage("objective", "value"), |p| {
            p.decision(1, |d| {
                let family = &mut d.objective.as_mut().expect("weighed").family;
                let sequence = family[0].sequence.as_mut().expect("a sequence");
                sequence.value = sequence.value.next_up();
            });
        }),
        forgery("a maximum taken off the map", All, Stage("candidates", "sites"), |p| {
            p.decision(1, |d| {
                d.candidates.as_mut().expect("candidates").sites.pop();
            });
        }),
        forgery("a map left out of a full log", All, Stage("fusion", "/map/interest"), |p| {
            let at = p.messages.iter().rposition(|m| m.topic == topic::INTEREST);
            p.messages.remove(at.expect("a map"));
        }),
        forgery("a map where it is not", All, Stage("fusion", "map"), |p| {
            // Where the map lies is the first number of its pose: 0 is not written, so it is added.
            let grid = p.messages.iter_mut().find(|m| m.topic == topic::INTEREST).expect("a map");
            let mut moved = foxglove::messages::Grid::decode(&grid.data[..]).expect("a grid");
            let place = moved.pose.as_mut().and_then(|pose| pose.position.as_mut());
            place.expect("a place").x = f64::NAN;
            grid.data = moved.encode_to_vec();
        }),
        forgery("one cell of a map", All, Stage("fusion", "/map/interest"), |p| {
            let grids = p.messages.iter_mut().filter(|m| m.topic == topic::INTEREST);
            let grid = grids.last().expect("a map");
            // The cells are the last field of the message: this is the sign of one of them.
            let at =
                grid.data.iter().rposition(|byte| *byte == 0x3f).expect("an interest above 0.5");
            grid.data[at] = 0x3e;
        }),
    ]
}

fn found(path: &Path, level: VerifyLevel) -> Verification {
    verify(path, level, &mut |_| {}).expect("the mission inside loads")
}

/// What is wrong with how a forgery was caught; nothing if it was, where it was made.
fn missed(folder: &Path, sound: &Path, forgery: &Forgery) -> Option<String> {
    let mut parts = Parts::of(sound);
    (forgery.forge)(&mut parts);
    let path = folder.join("forged.mcap");
    parts.write(&path, forgery.repair);
    let log = LogReader::open(&path).expect("a container");
    if forgery.repair == Repair::All
        && !(log.status == Status::Complete && found(&path, VerifyLevel::Identity).holds())
    {
        return Some(format!("the forger did bad work: {:?}", log.status));
    }
    let told = |difference: Option<Difference>| {
        difference.map_or_else(|| "nothing".to_owned(), |difference| difference.to_string())
    };
    match forgery.caught {
        Caught::File(words) => match &log.status {
            Status::Corrupt { detail, .. } if detail.contains(words) => {
                found(&path, VerifyLevel::File).holds().then(|| "it holds".to_owned())
            }
            status => Some(format!("{status}")),
        },
        Caught::Identity(field) => match found(&path, VerifyLevel::Identity).difference {
            Some(d) if (d.stage, d.path.as_str()) == ("identity", field) => None,
            other => Some(told(other)),
        },
        Caught::Stage(stage, field) => match found(&path, VerifyLevel::Redecide).difference {
            Some(d) if d.stage.contains(stage) && d.path.contains(field) && d.left != d.right => {
                println!("{}: {d}", forgery.name);
                None
            }
            other => Some(told(other)),
        },
        Caught::Driven(field) => {
            let by_deciding = found(&path, VerifyLevel::Redecide);
            if !by_deciding.holds() {
                return Some(format!("{by_deciding:?}"));
            }
            match found(&path, VerifyLevel::Resimulate).difference {
                Some(d) if d.stage == "simulation" && d.path.contains(field) => {
                    println!("{}: {d}", forgery.name);
                    None
                }
                other => Some(told(other)),
            }
        }
    }
}

#[test]
fn what_is_taken_apart_and_put_together_is_sound() {
    let folder = tempfile::tempdir().expect("a folder");
    let sound = sound(folder.path());
    for repair in [Repair::Checksums, Repair::All] {
        let path = folder.path().join("again.mcap");
        Parts::of(&sound).write(&path, repair);
        let found = found(&path, VerifyLevel::Resimulate);
        assert!(found.holds() && found.status == Status::Complete, "{found:?}");
        assert!(found.decisions > 3, "{}", found.decisions);
    }
}

#[test]
fn every_forgery_is_caught_where_it_was_made() {
    let folder = tempfile::tempdir().expect("a folder");
    let sound = sound(folder.path());
    let forgeries: Vec<Forgery> =
        of_the_file().into_iter().chain(of_inputs()).chain(of_outputs()).collect();
    assert!(forgeries.len() >= 20);
    let missed: Vec<(&str, String)> = forgeries
        .iter()
        .filter_map(|forgery| Some((forgery.name, missed(folder.path(), &sound, forgery)?)))
        .collect();
    assert!(missed.is_empty(), "{missed:#?}");
    println!("{} kinds of forged logs caught", forgeries.len());
}
