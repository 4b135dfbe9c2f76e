//! The modules of a crate in the order in which their parents list them, and which of them each uses.

use std::collections::BTreeMap;
use std::path::{Path as File, PathBuf};

use crate::paths::{Path, paths, uses};
use crate::source::code;

/// The modules of a crate by their paths from its root, which is empty.
pub struct Modules(BTreeMap<Path, Module>);

struct Module {
    file: PathBuf,
    code: String,
    /// In the order of their `mod` lines.
    children: Vec<String>,
    /// The paths under which `use` lines make names known.
    names: Vec<Path>,
}

impl Modules {
    /// Of the crate whose root is this file; `text` gives the text of a file, where there is one.
    pub fn of(root: &File, text: &dyn Fn(&File) -> Option<String>) -> Self {
        let mut modules = Self(BTreeMap::new());
        let folder = root.parent().expect("a root has a folder");
        modules.read(Vec::new(), &[root.to_path_buf()], folder, text);
        modules
    }

    /// Reads the first of some files that there is, and what it declares.
    fn read(&mut self, path: Path, files: &[PathBuf], folder: &File, text: &dyn Fn(&File) -> Option<String>) {
        let found = files.iter().find_map(|file| Some((file, text(file)?)));
        let (file, text_of_file) = found.unwrap_or_else(|| panic!("no file is {files:?}"));
        let code = code(&text_of_file);
        let children: Vec<String> = code.lines().filter_map(declared).collect();
        for child in &children {
            let below = folder.join(child);
            let files = [below.with_extension("rs"), below.join("mod.rs")];
            let path = path.iter().chain([child]).cloned().collect();
            self.read(path, &files, &below, text);
        }
        let module = Module {
            file: file.clone(),
            names: uses(&code),
            code,
            children,
        };
        self.0.insert(path, module);
    }

    /// Number of files.
    pub fn len(&self) -> usize {
        self.0.len()
    }

    /// What uses something that is not declared above it, file by file: the file, and the path of the module.
    pub fn offences(&self) -> Vec<(PathBuf, String)> {
        let mut offences = Vec::new();
        for (path, module) in &self.0 {
            let used = paths(&module.code)
                .into_iter()
                .filter_map(|used| self.resolve(path, &used, 0));
            let below = used.filter(|used| !self.may_use(path, used));
            offences.extend(below.map(|used| (module.file.clone(), used.join("::"))));
        }
        offences.sort();
        offences.dedup();
        offences
    }

    /// True where the other is above in the list in which their paths part; parents and children may use each other.
    fn may_use(&self, path: &Path, used: &Path) -> bool {
        let common = path.iter().zip(used).take_while(|(own, other)| own == other).count();
        let (Some(own), Some(other)) = (path.get(common), used.get(common)) else {
            return true;
        };
        let list = &self.0[&path[..common]].children;
        let place = |name| list.iter().position(|child| child == name);
        place(other) < place(own)
    }

    /// The module in which a path ends that stands in the module `at`; `None` of one outside of the crate.
    fn resolve(&self, at: &Path, path: &Path, depth: usize) -> Option<Path> {
        const DEEPEST: usize = 10;
        let parents = path.iter().take_while(|name| *name == "super").count();
        let is_child = |name: &str| self.0[at].children.iter().any(|child| child == name);
        let (from, rest) = match path.first()?.as_str() {
            "crate" => (&[][..], &path[1..]),
            "self" => (&at[..], &path[1..]),
            "super" => (&at[..at.len() - parents], &path[parents..]),
            name if is_child(name) => (&at[..], &path[..]),
            _ => return None,
        };
        (depth < DEEPEST).then(|| self.walk(from.to_vec(), rest, depth + 1))
    }

    /// From a module along a path as far as there are modules, or names that a `use` brought there.
    fn walk(&self, mut here: Path, path: &[String], depth: usize) -> Path {
        for name in path {
            let next: Path = here.iter().chain([name]).cloned().collect();
            if self.0.contains_key(&next) {
                here = next;
                continue;
            }
            let brought = self.0[&here].names.iter().filter(|path| path.last() == Some(name));
            return brought
                .filter_map(|path| self.resolve(&here, path, depth))
                .next()
                .unwrap_or(here);
        }
        here
    }
}

/// The name in a `mod` line that has a file.
fn declared(line: &str) -> Option<String> {
    let line = line.trim().strip_suffix(';')?;
    let name = line
        .split_once("mod ")
        .filter(|(before, _)| before.is_empty() || before.starts_with("pub"))?;
    Some(name.1.to_string())
}
