//! The paths that code names.

/// The segments of a path.
pub type Path = Vec<String>;

/// Every path of a text that begins with `crate` or `super`.
pub fn paths(code: &str) -> Vec<Path> {
    let begins = |before: &str| !before.ends_with(|c: char| c.is_alphanumeric() || c == '_' || c == ':');
    let of_root = |root| code.match_indices(root).filter(|(at, _)| begins(&code[..*at]));
    let all = of_root("crate::").chain(of_root("super::"));
    all.flat_map(|(at, _)| branches(&code[at..])).collect()
}

/// The paths of all `use` lines.
pub fn uses(code: &str) -> Vec<Path> {
    let lines = code.match_indices("use ");
    let is_item = |before: &str| {
        let line = before.rsplit('\n').next().unwrap_or("").trim();
        line.is_empty() || line.starts_with("pub")
    };
    let items = lines.filter(|(at, _)| is_item(&code[..*at]));
    items
        .flat_map(|(at, found)| branches(&code[at + found.len()..]))
        .collect()
}

/// The path at the beginning of a text; several where it ends in a list.
fn branches(text: &str) -> Vec<Path> {
    let text = text.trim_start();
    if let Some(list) = text.strip_prefix('{') {
        return members(list).into_iter().flat_map(branches).collect();
    }
    let name = first_word(text);
    let Some(rest) = text[name.len()..].strip_prefix("::").filter(|_| !name.is_empty()) else {
        return vec![if name.is_empty() { Vec::new() } else { vec![name] }];
    };
    let with_name = |path: Path| std::iter::once(name.clone()).chain(path).collect();
    branches(rest).into_iter().map(with_name).collect()
}

/// The members of a list whose first brace is open already.
fn members(list: &str) -> Vec<&str> {
    let (mut depth, mut first, mut members) = (0, 0, Vec::new());
    for (at, letter) in list.char_indices() {
        match letter {
            '{' => depth += 1,
            '}' if depth == 0 => {
                members.push(&list[first..at]);
                break;
            }
            '}' => depth -= 1,
            ',' if depth == 0 => {
                members.push(&list[first..at]);
                first = at + 1;
            }
            _ => {}
        }
    }
    members
}

fn first_word(text: &str) -> String {
    let letters = text.chars().take_while(|c| c.is_alphanumeric() || *c == '_');
    letters.collect()
}
