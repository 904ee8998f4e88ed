//! A campaign's folder: its manifest, its mission, and a file a run.

use std::fs::{self, File, OpenOptions};
use std::io::{ErrorKind, Write};
use std::path::{Component, Path, PathBuf};

use anyhow::Context;
use serde::{Deserialize, Serialize};
use wisdom_logbook::record::DECISION_VERSION;
use wisdom_mission::{Case, MISSION_FILE, Mission, Override, Plan, ROW_VERSION, Row, RowResult};

use crate::exit::InputError;

/// The file that says what a campaign is.
const MANIFEST: &str = "campaign.toml";

/// The folder of the mission's files.
const MISSION: &str = "mission";

/// What the mission's files are gathered in before they get their name.
const MISSION_PART: &str = ".mission.part";

/// The folder of rows, a file a run.
const RUNS: &str = "runs";

/// The folder of wall times, a file a run: they differ from machine to machine, and rows must not.
const TIMES: &str = "times";

/// The version of [`Manifest`].
const VERSION: u32 = 1;

/// How a mission names what it carries in the stead of a file too large to be carried.
const REFERENCE: &str = ".reference.toml";

/// What a campaign is: all that its rows hang on.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case", deny_unknown_fields)]
pub(super) struct Manifest {
    /// [`VERSION`].
    version: u32,
    /// The version of this program.
    product: String,
    /// The version of how it decides.
    decision_version: u32,
    /// The mission's name.
    pub(super) mission: String,
    /// Digest of the mission's files, its changes applied.
    digest: String,
    /// The mission's own file, where its files cannot be carried along.
    #[serde(skip_serializing_if = "Option::is_none")]
    place: Option<PathBuf>,
    /// The changes to the mission.
    set: Vec<String>,
    rules: Vec<String>,
    policies: Vec<String>,
    seeds: Vec<u64>,
}

impl Manifest {
    /// The manifest of a campaign over a mission, read from `path`.
    pub(super) fn of(mission: &Mission, path: &Path, plan: &Plan) -> anyhow::Result<Self> {
        let file = if path.is_dir() { path.join(MISSION_FILE) } else { path.to_path_buf() };
        let place = if is_carried(mission) { None } else { Some(file.canonicalize()?) };
        let mut manifest = Self {
            version: VERSION,
            product: env!("CARGO_PKG_VERSION").to_owned(),
            decision_version: DECISION_VERSION,
            mission: mission.name.clone(),
            digest: hex(&mission.digest),
            place,
            set: mission.overrides.iter().map(|o| format!("{}={}", o.key, o.value)).collect(),
            rules: Vec::new(),
            policies: Vec::new(),
            seeds: plan.seeds().to_vec(),
        };
        let once = |names: &mut Vec<String>, name: String| {
            if !names.contains(&name) {
                names.push(name);
            }
        };
        for variant in plan.variants() {
            once(&mut manifest.rules, variant.rule.to_string());
            once(&mut manifest.policies, variant.policy.to_string());
        }
        Ok(manifest)
    }

    /// The runs it names.
    fn plan(&self) -> anyhow::Result<Plan> {
        let rules = self.rules.iter().map(|r| r.parse()).collect::<Result<Vec<_>, _>>()?;
        let policies = self.policies.iter().map(|p| p.parse()).collect::<Result<Vec<_>, _>>()?;
        Ok(Plan::new(self.seeds.clone(), &rules, &policies)?)
    }

    /// The changes to the mission.
    fn overrides(&self) -> Vec<Override> {
        self.set
            .iter()
            .filter_map(|change| change.split_once('='))
            .map(|(key, value)| Override::new(key, value))
            .collect()
    }

    /// How this program differs from the one that made the campaign, where rows may hang on it.
    fn program_difference(&self) -> Option<String> {
        let product = env!("CARGO_PKG_VERSION");
        let differs = |what: &str, here: &str, mine: &str| {
            (here != mine).then(|| {
                format!("it was made by {what} {here}, this is {mine}; results are not mixed")
            })
        };
        differs("wisdom", &self.product, product)
            .or_else(|| {
                let (here, mine) = (self.decision_version, DECISION_VERSION);
                differs("decision version", &here.to_string(), &mine.to_string())
            })
            .or_else(|| differs("layout version", &self.version.to_string(), &VERSION.to_string()))
    }

    /// The first thing in which the rows of two campaigns would differ, ours first; more seeds at the end are none.
    fn first_difference(&self, wanted: &Self, given: Given) -> Option<String> {
        let differs = |what: &str, here: String, whose: &str, there: String| {
            (here != there).then(|| format!("its {what} {here}, and the {whose}'s {there}"))
        };
        let list = |names: &[String]| names.join(",");
        let whose = |given: bool| if given { "call" } else { "mission" };
        differs("mission is", self.mission.clone(), "call", wanted.mission.clone())
            .or_else(|| {
                // Changes written otherwise may come to the same; the digest knows.
                let same = self.digest == wanted.digest;
                let shown = |set: &[String]| {
                    if set.is_empty() { "none".to_owned() } else { set.join(" ") }
                };
                (!same).then(|| {
                    differs("changes are", shown(&self.set), "call", shown(&wanted.set)).or_else(
                        || {
                            let digest = |of: &Self| of.digest.clone();
                            differs("mission has digest", digest(self), "call", digest(wanted))
                        },
                    )
                })?
            })
            .or_else(|| {
                differs("rules are", list(&self.rules), whose(given.rules), list(&wanted.rules))
            })
            .or_else(|| {
                let (here, there) = (list(&self.policies), list(&wanted.policies));
                differs("policies are", here, whose(given.policies), there)
            })
            .map(|difference| format!("{difference}; give the same"))
            .or_else(|| self.seeds_difference(&wanted.seeds))
    }

    /// Seeds may be added behind the others only: runs are numbered seed by seed.
    fn seeds_difference(&self, wanted: &[u64]) -> Option<String> {
        let turns = self.seeds.len().min(wanted.len());
        if let Some(turn) = (0..turns).find(|&turn| self.seeds[turn] != wanted[turn]) {
            return Some(format!(
                "its seed number {} is {}, and the call's {}; seeds can be added behind the others only, as runs \
                 are numbered seed by seed; give the same",
                turn + 1,
                self.seeds[turn],
                wanted[turn]
            ));
        }
        (wanted.len() < self.seeds.len()).then(|| {
            format!(
                "it has {} seeds, and the call names the first {} of them; give all, and more behind them if you like",
                self.seeds.len(),
                wanted.len()
            )
        })
    }
}

/// What a call names; what it does not is the mission's.
#[derive(Debug, Clone, Copy)]
pub(super) struct Given {
    pub(super) rules: bool,
    pub(super) policies: bool,
}

/// Whether a folder can hold all of the mission: not ground larger than memory, and nothing that lies outside its
/// own folder.
fn is_carried(mission: &Mission) -> bool {
    let inside =
        |path: &str| Path::new(path).components().all(|c| matches!(c, Component::Normal(_)));
    mission.files.keys().all(|path| inside(path) && !path.ends_with(REFERENCE))
}

/// A campaign's folder.
pub(super) struct Folder {
    place: PathBuf,
    pub(super) manifest: Manifest,
    pub(super) plan: Plan,
}

/// What is there of a run.
pub(super) enum Kept {
    Nothing,
    Whole(Row),
    /// A file that is no row of this run, and why.
    Spoiled(String),
}

impl Folder {
    /// Makes the folder of a campaign, or takes up the one that is there if it is of the same campaign. Seeds that
    /// are new at the end are added to it.
    pub(super) fn prepare(
        place: &Path,
        wanted: &Manifest,
        given: Given,
        mission: &Mission,
    ) -> anyhow::Result<Self> {
        let shown = place.display();
        if place.is_file() {
            let message = format!("-o {shown}: is a file; a folder is expected");
            return Err(InputError(message).into());
        }
        if !place.join(MANIFEST).exists() {
            begin(place, wanted)?;
        }
        let found = Self::open(place)?;
        found.check_program()?;
        if let Some(difference) = found.manifest.first_difference(wanted, given) {
            let message =
                format!("{shown} holds another campaign: {difference}, or another folder with -o");
            return Err(InputError(message).into());
        }
        if found.manifest.seeds.len() < wanted.seeds.len() || found.manifest.place != wanted.place {
            let set = found.manifest.set.clone();
            write_manifest(place, &Manifest { set, ..wanted.clone() })?;
        }
        if wanted.place.is_none() {
            keep_mission(place, mission)?;
        }
        Self::open(place)
    }

    /// Opens the folder of a campaign that was made before.
    pub(super) fn open(place: &Path) -> anyhow::Result<Self> {
        if place.is_file() {
            let message =
                format!("{}: is a file; a campaign's folder is expected", place.display());
            return Err(InputError(message).into());
        }
        let path = place.join(MANIFEST);
        let error = |message: String| InputError(format!("{}: {message}", path.display()));
        let text = fs::read_to_string(&path).map_err(|e| match e.kind() {
            ErrorKind::NotFound => {
                let hint = "`wisdom campaign MISSION --seeds ... -o DIR` makes one";
                InputError(format!("{} is no campaign's folder; {hint}", place.display()))
            }
            _ => error(e.to_string()),
        })?;
        let manifest: Manifest = toml::from_str(&text).map_err(|e| error(e.to_string()))?;
        let plan = manifest.plan().map_err(|e| error(e.to_string()))?;
        let folder = Self { place: place.to_path_buf(), manifest, plan };
        for sub in [RUNS, TIMES] {
            let path = place.join(sub);
            fs::create_dir_all(&path).with_context(|| path.display().to_string())?;
        }
        Ok(folder)
    }

    /// How this program differs from the one that made the campaign, where rows may hang on it.
    pub(super) fn program_difference(&self) -> Option<String> {
        self.manifest.program_difference()
    }

    fn check_program(&self) -> Result<(), InputError> {
        match self.program_difference() {
            None => Ok(()),
            Some(difference) => {
                let message = format!("{}: {difference}; start anew with another -o", self.shown());
                Err(InputError(message))
            }
        }
    }

    /// Checks that this program would compute the campaign's own rows: the same version, the same mission.
    pub(super) fn check(&self) -> anyhow::Result<()> {
        self.check_program()?;
        let digest = hex(&self.load(&[])?.digest);
        if digest != self.manifest.digest {
            let what = match &self.manifest.place {
                None => format!("{}/", self.place.join(MISSION).display()),
                Some(file) => format!("the mission {}", file.display()),
            };
            let message = format!(
                "{what} was changed since the campaign was made (digest {}, then {}); put it back, or start anew with \
                 another -o",
                start(&digest),
                start(&self.manifest.digest)
            );
            return Err(InputError(message).into());
        }
        Ok(())
    }

    /// Reads the campaign's mission with further changes.
    fn load(&self, more: &[Override]) -> anyhow::Result<Mission> {
        let Some(file) = &self.manifest.place else {
            return Ok(Mission::load(&self.place.join(MISSION), more)?);
        };
        let mut overrides = self.manifest.overrides();
        overrides.extend_from_slice(more);
        Ok(Mission::load(file, &overrides)?)
    }

    /// The mission of one run.
    pub(super) fn mission(&self, case: &Case) -> anyhow::Result<Mission> {
        self.load(&case.overrides())
    }

    /// Where a file of the campaign goes.
    pub(super) fn path(&self, name: &str) -> PathBuf {
        self.place.join(name)
    }

    /// The folder as it was named.
    pub(super) fn shown(&self) -> std::path::Display<'_> {
        self.place.display()
    }

    /// Where the row of a run is kept.
    pub(super) fn row_path(&self, index: usize) -> PathBuf {
        self.place.join(RUNS).join(format!("{index:06}.json"))
    }

    /// What is there of a run.
    pub(super) fn kept(&self, case: &Case) -> anyhow::Result<Kept> {
        let path = self.row_path(case.index);
        let bytes = match fs::read(&path) {
            Ok(bytes) => bytes,
            Err(error) if error.kind() == ErrorKind::NotFound => return Ok(Kept::Nothing),
            Err(error) => return Err(error).with_context(|| path.display().to_string()),
        };
        let spoiled = |why: String| Kept::Spoiled(format!("{}: {why}", path.display()));
        Ok(match serde_json::from_slice::<Row>(&bytes) {
            Err(error) => spoiled(format!("no whole row ({error})")),
            Ok(row) if row.version != ROW_VERSION => spoiled(format!(
                "a row of version {}; this program writes {ROW_VERSION}",
                row.version
            )),
            Ok(row) if !row.is_unchanged() => {
                spoiled("a row that was edited (its digest does not fit it)".into())
            }
            Ok(row) if !row.is_of(case) => spoiled("the row of another run".into()),
            Ok(row) if text(&row)?.as_bytes() != bytes => {
                spoiled("a row that was edited (it is written otherwise)".into())
            }
            Ok(row) => Kept::Whole(row),
        })
    }

    /// Keeps the row of a run, and how long it took on the wall.
    pub(super) fn keep(&self, row: &Row, wall_s: f64) -> anyhow::Result<()> {
        write_whole(&self.row_path(row.index), text(row)?.as_bytes())?;
        let time = self.place.join(TIMES).join(format!("{:06}.json", row.index));
        fs::write(&time, format!("{}\n", serde_json::json!({ "wall_s": wall_s })))
            .with_context(|| time.display().to_string())
    }

    /// Removes what killed processes left of rows they were writing. A process that is alive writes its row again.
    pub(super) fn clear_parts(&self) -> anyhow::Result<()> {
        let runs = self.place.join(RUNS);
        let at = || runs.display().to_string();
        for entry in fs::read_dir(&runs).with_context(at)? {
            let name = entry.with_context(at)?.file_name();
            let name = name.to_string_lossy();
            if name.starts_with('.') && name.ends_with(PART) {
                match fs::remove_file(runs.join(&*name)) {
                    Err(error) if error.kind() != ErrorKind::NotFound => {
                        return Err(error).with_context(at);
                    }
                    _ => {}
                }
            }
        }
        Ok(())
    }

    /// All runs: rows that are there, in order, and the runs still to be done, of which spoiled and failed ones are
    /// told to `remark`.
    pub(super) fn survey(
        &self,
        remark: &mut dyn FnMut(&str),
    ) -> anyhow::Result<(Vec<Row>, Vec<Case>)> {
        let (mut rows, mut open) = (Vec::new(), Vec::new());
        for case in self.plan.cases() {
            match self.kept(&case)? {
                Kept::Nothing => open.push(case),
                Kept::Whole(row) => {
                    // A failure may have come from outside (a disk, a file): it is tried again.
                    if matches!(row.result, RowResult::Failed { .. }) {
                        open.push(case);
                    }
                    rows.push(row);
                }
                Kept::Spoiled(why) => {
                    remark(&format!("{why}; run {} has to be computed again", case.index));
                    open.push(case);
                }
            }
        }
        Ok((rows, open))
    }
}

/// A row as it is written.
fn text(row: &Row) -> anyhow::Result<String> {
    Ok(serde_json::to_string(row)? + "\n")
}

/// Makes a new campaign's folder, its manifest last.
fn begin(place: &Path, manifest: &Manifest) -> anyhow::Result<()> {
    let at = |e: std::io::Error| InputError(format!("-o {}: {e}", place.display()));
    fs::create_dir_all(place).map_err(at)?;
    for entry in fs::read_dir(place).map_err(at)? {
        let name = entry.map_err(at)?.file_name();
        // Left by a campaign that ended before its manifest was whole.
        if !name.to_string_lossy().starts_with(&format!(".{MANIFEST}")) && name != MANIFEST {
            let message = format!(
                "-o {}: it holds {} and no campaign; name a new or empty folder",
                place.display(),
                name.to_string_lossy()
            );
            return Err(InputError(message).into());
        }
    }
    write_manifest(place, manifest)
}

/// Copies the mission's files into a campaign's folder, unless they are there: whole, under a name of this process's own
/// first, so that neither a call that was killed nor one beside it leaves half a mission.
fn keep_mission(place: &Path, mission: &Mission) -> anyhow::Result<()> {
    let kept = place.join(MISSION);
    if kept.exists() {
        return Ok(());
    }
    let part = place.join(format!("{MISSION_PART}-{}", std::process::id()));
    for (path, bytes) in &mission.files {
        let path = part.join(path);
        let folder = path.parent().unwrap_or(&part);
        fs::create_dir_all(folder)
            .and_then(|()| fs::write(&path, bytes))
            .with_context(|| path.display().to_string())?;
    }
    if let Err(error) = fs::rename(&part, &kept) {
        let _ = fs::remove_dir_all(&part);
        // Another call was quicker: the same manifest asks for the same files, and they are checked by digest.
        if !kept.exists() {
            return Err(error).with_context(|| kept.display().to_string());
        }
    }
    Ok(())
}

fn write_manifest(place: &Path, manifest: &Manifest) -> anyhow::Result<()> {
    write_whole(&place.join(MANIFEST), toml::to_string(manifest)?.as_bytes())
}

/// How the name of a file ends that is being written.
const PART: &str = ".part";

/// Writes a file so that it is there whole or not at all: under another name, synced, then renamed.
pub(super) fn write_whole(path: &Path, bytes: &[u8]) -> anyhow::Result<()> {
    let write = || write_by(path, |file| Ok(file.write_all(bytes)?));
    // Another call may just have cleared the part away; it does so once, as it begins.
    write().or_else(|error| {
        let gone = |e: &std::io::Error| e.kind() == ErrorKind::NotFound;
        let gone = error.root_cause().downcast_ref().is_some_and(gone);
        if gone { write() } else { Err(error) }
    })
}

/// As [`write_whole`], with the file's content written by a function.
pub(super) fn write_by(
    path: &Path,
    write: impl FnOnce(&mut File) -> anyhow::Result<()>,
) -> anyhow::Result<()> {
    let folder = path.parent().expect("a campaign's files lie in its folder");
    let name = path.file_name().expect("a file has a name").to_string_lossy();
    // Others may write the same row at the same time: each under a name of its own.
    let (part, mut file) = (0u32..)
        .map(|n| folder.join(format!(".{name}.{}-{n}{PART}", std::process::id())))
        .find_map(|part| match OpenOptions::new().write(true).create_new(true).open(&part) {
            Ok(file) => Some(Ok((part, file))),
            Err(error) if error.kind() == ErrorKind::AlreadyExists => None,
            Err(error) => Some(Err(error)),
        })
        .expect("the names do not end")
        .with_context(|| path.display().to_string())?;
    let written = write(&mut file)
        .and_then(|()| Ok(file.sync_all()?))
        .and_then(|()| Ok(fs::rename(&part, path)?))
        .and_then(|()| sync_folder(folder));
    if written.is_err() {
        // What could not be finished is in nobody's way.
        let _ = fs::remove_file(&part);
    }
    written.with_context(|| path.display().to_string())
}

/// Makes a renaming last, where folders can be opened.
fn sync_folder(folder: &Path) -> anyhow::Result<()> {
    if cfg!(unix) {
        File::open(folder)?.sync_all()?;
    }
    Ok(())
}

fn hex(digest: &[u8]) -> String {
    digest.iter().fold(String::new(), |text, byte| text + &format!("{byte:02x}"))
}

/// As much of a digest as tells it from another at a glance.
fn start(digest: &str) -> &str {
    digest.get(..12).unwrap_or(digest)
}
