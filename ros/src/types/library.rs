//! Lookup of types by name: in the folders of the user, in installations of ROS, and in this program.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::{
    Base, Literal, MESSAGE_MAX, Message, Primitive, Shape, Sort, TypeName, bundled, derived, hash,
    parse,
};

/// Maximum nesting of types.
pub(crate) const DEPTH_MAX: usize = 64;
/// Maximum size of an interface file, in bytes.
const FILE_MAX: u64 = 1 << 20;

/// A message type with its nested types.
#[derive(Debug)]
pub(crate) struct Type {
    pub(crate) name: String,
    pub(crate) fields: Vec<TypeField>,
    pub(crate) constants: Vec<(String, Primitive, Literal)>,
    /// Levels of types: 1 if all fields are primitive.
    depth: usize,
    least_width: usize,
    is_large: bool,
}

/// A field of a message type.
#[derive(Debug)]
pub(crate) struct TypeField {
    pub(crate) name: String,
    pub(crate) kind: Kind,
    pub(crate) shape: Shape,
    pub(crate) text_max: u32,
    pub(crate) default: Option<Literal>,
}

/// The type of a single value of a field.
#[derive(Debug)]
pub(crate) enum Kind {
    Primitive(Primitive),
    Message(Arc<Type>),
}

impl Type {
    /// Computes the sizes once, because a type can contain another one in two fields on each of 64 levels.
    fn new(message: &Message, fields: Vec<TypeField>) -> Self {
        let nested = || fields.iter().filter_map(|field| field.kind.nested());
        let depth = 1 + nested().map(|nested| nested.depth).max().unwrap_or(0);
        let is_large = nested().any(|nested| nested.is_large)
            || fields.iter().any(TypeField::holds_bytes_without_end);
        let widths = fields.iter().map(TypeField::least_width);
        let least_width = widths.fold(0_usize, usize::saturating_add).max(1);
        let (name, constants) = (message.name.clone(), message.constants.clone());
        Self { name, fields, constants, depth, least_width, is_large }
    }

    /// True if messages can have megabytes, because they contain unbounded lists of bytes.
    pub(crate) fn is_large(&self) -> bool {
        self.is_large
    }
}

impl TypeField {
    fn least_width(&self) -> usize {
        match self.shape {
            Shape::One => self.kind.least_width(),
            Shape::Fixed(size) => self.kind.least_width().saturating_mul(size as usize),
            Shape::Bounded(_) | Shape::Unbounded => 4,
        }
    }

    fn holds_bytes_without_end(&self) -> bool {
        matches!(self.kind, Kind::Primitive(one) if self.shape == Shape::Unbounded && one.width() == 1)
    }
}

impl Kind {
    /// The minimum number of bytes of a value, for checking a claimed number of values.
    pub(crate) fn least_width(&self) -> usize {
        match self {
            Self::Primitive(primitive) => primitive.width(),
            Self::Message(nested) => nested.least_width,
        }
    }

    fn nested(&self) -> Option<&Type> {
        match self {
            Self::Primitive(_) => None,
            Self::Message(nested) => Some(nested),
        }
    }
}

/// Folders of types, and a cache of loaded types.
pub(crate) struct Library {
    /// Folders with `FOLDER/PACKAGE/msg/NAME.msg`; duplicates must be identical.
    folders: Vec<PathBuf>,
    /// Folders of installations; the first match is used.
    installed: Vec<PathBuf>,
    read: BTreeMap<String, Arc<Message>>,
    types: BTreeMap<String, Arc<Type>>,
}

impl Library {
    /// A library that searches `folders` first, then `share` below each of `prefixes`, then this program.
    pub(crate) fn new(folders: Vec<PathBuf>, prefixes: &[PathBuf]) -> Self {
        let installed = prefixes.iter().map(|prefix| prefix.join("share")).collect();
        Self { folders, installed, read: BTreeMap::new(), types: BTreeMap::new() }
    }

    /// The type with this full name, or a part of a service or action.
    pub(crate) fn find(&mut self, full: &str) -> Result<Arc<Type>, String> {
        self.resolve(full, &mut Vec::new())
    }

    /// True if only this program contains the file of this type, or of its service or action.
    pub(crate) fn is_bundled(&self, full: &str) -> bool {
        let Ok(name) = TypeName::parse(full) else { return false };
        let short = name.whole();
        let relative = relative(name.package, name.sort, short);
        bundled::find(name.package, name.sort.word(), short).is_some()
            && !self.folders.iter().chain(&self.installed).any(|at| at.join(&relative).exists())
    }

    /// Adds a type from a remote description: the first of `messages`, if its hash matches the announced one, with its
    /// nested types.
    pub(crate) fn learn(&mut self, messages: Vec<Message>, announced: &str) -> Result<(), String> {
        let names: Vec<String> = messages.iter().map(|message| message.name.clone()).collect();
        let top = names.first().ok_or("nothing is described")?;
        let read = messages.into_iter().map(|message| (message.name.clone(), Arc::new(message)));
        let mut told = Self { read: read.collect(), ..Self::new(Vec::new(), &[]) };
        let found = hash::rihs01(&*told.find(top)?);
        if found != announced {
            return Err(format!("{top} is announced as {announced}, and described as {found}"));
        }
        for name in &names {
            let new = told.find(name)?;
            let own = self.types.get(name).map(|own| hash::rihs01(own));
            if own.is_some_and(|own| own != hash::rihs01(&new)) && !self.is_bundled(name) {
                return Err(format!("its {name} is another than the one in use here"));
            }
            self.types.insert(name.clone(), new);
        }
        Ok(())
    }

    fn resolve(&mut self, full: &str, above: &mut Vec<String>) -> Result<Arc<Type>, String> {
        if let Some(known) = self.types.get(full) {
            return within_depth(known, above).map(|()| Arc::clone(known));
        }
        if above.iter().any(|name| name == full) {
            return Err(format!("`{full}` contains itself, by {}", above.join(", ")));
        }
        if let Some(top) = above.first().filter(|_| above.len() >= DEPTH_MAX) {
            return Err(too_deep(top));
        }
        let message = self.message(full).map_err(|why| match above.last() {
            Some(user) => format!("{why} (it is needed by {user})"),
            None => why,
        })?;
        above.push(full.to_owned());
        let mut fields = Vec::with_capacity(message.fields.len());
        for field in &message.fields {
            let kind = match &field.base {
                Base::Primitive(primitive) => Kind::Primitive(*primitive),
                Base::Message(nested) => Kind::Message(self.resolve(nested, above)?),
            };
            let (name, default) = (field.name.clone(), field.default.clone());
            fields.push(TypeField {
                name,
                kind,
                shape: field.shape,
                text_max: field.text_max,
                default,
            });
        }
        above.pop();
        let found = Type::new(&message, fields);
        if found.least_width > MESSAGE_MAX {
            let (least, most) = (found.least_width, MESSAGE_MAX);
            return Err(format!(
                "the shortest message of `{full}` has {least} bytes, and {most} is the most that rafcon-ros carries"
            ));
        }
        let found = Arc::new(found);
        self.types.insert(full.to_owned(), Arc::clone(&found));
        Ok(found)
    }

    /// The message with this name, without its nested types.
    fn message(&mut self, full: &str) -> Result<Arc<Message>, String> {
        if let Some(known) = self.read.get(full) {
            return Ok(Arc::clone(known));
        }
        let name = TypeName::parse(full)?;
        // Parts of a service or action are in its file.
        let file = TypeName { name: name.whole(), ..name };
        for message in self.file(&file)? {
            self.read.insert(message.name.clone(), Arc::new(message));
        }
        let found = self.read.get(full).map(Arc::clone);
        found.ok_or_else(|| format!("{file} has no part `{}`", name.name))
    }

    /// The messages in the interface file of `name`, and those derived from it.
    fn file(&self, name: &TypeName<'_>) -> Result<Vec<Message>, String> {
        let full = name.to_string();
        let mut messages = self.parsed(name)?;
        match name.sort {
            Sort::Message => {}
            Sort::Service => messages.extend(derived::of_service(&full)),
            Sort::Action => messages.extend(derived::of_action(&full)),
        }
        Ok(messages)
    }

    fn parsed(&self, name: &TypeName<'_>) -> Result<Vec<Message>, String> {
        let TypeName { package, sort, name: short } = name;
        let parse = |text: &str| parse::file(text, package, *sort, short);
        let relative = relative(package, *sort, short);
        let mut own: Option<(PathBuf, Vec<Message>)> = None;
        for path in self.folders.iter().map(|folder| folder.join(&relative)) {
            let Some(text) = read(&path)? else { continue };
            let messages = parse(&text).map_err(|why| format!("{}: {why}", path.display()))?;
            if let Some((other, known)) = &own
                && *known != messages
            {
                let (one, two) = (other.display(), path.display());
                return Err(format!(
                    "{name} is two different types, in {one} and in {two}: remove one of the files"
                ));
            }
            own.get_or_insert((path, messages));
        }
        if let Some((_, messages)) = own {
            return Ok(messages);
        }
        for path in self.installed.iter().map(|folder| folder.join(&relative)) {
            if let Some(text) = read(&path)? {
                return parse(&text).map_err(|why| format!("{}: {why}", path.display()));
            }
        }
        match bundled::find(package, sort.word(), short) {
            Some(text) => parse(text),
            None => Err(self.unknown(name, &relative)),
        }
    }

    fn unknown(&self, name: &TypeName<'_>, relative: &Path) -> String {
        let places = self.folders.iter().chain(&self.installed);
        let places: Vec<String> = places.map(|place| place.display().to_string()).collect();
        let looked = if places.is_empty() {
            String::new()
        } else {
            format!(", nor in {}", places.join(", "))
        };
        let relative = relative.display();
        format!(
            "there is no type {name}: it is not among those of rafcon-ros{looked}. Put its file at FOLDER/{relative} and name FOLDER in RAFCON_ROS_TYPES, or source the ROS workspace that has it"
        )
    }
}

/// Refuses a known type that is nested too deep in its containers.
fn within_depth(known: &Type, above: &[String]) -> Result<(), String> {
    match above.first() {
        Some(top) if above.len() + known.depth > DEPTH_MAX => Err(too_deep(top)),
        _ => Ok(()),
    }
}

fn too_deep(top: &str) -> String {
    format!("`{top}` is nested more than {DEPTH_MAX} deep")
}

/// Path of an interface file in a folder of interfaces.
fn relative(package: &str, sort: Sort, short: &str) -> PathBuf {
    PathBuf::from(package).join(sort.word()).join(format!("{short}.{}", sort.word()))
}

/// The text of a file, or `None` if the file is missing.
fn read(path: &Path) -> Result<Option<String>, String> {
    let Ok(about) = path.metadata() else { return Ok(None) };
    if about.len() > FILE_MAX {
        return Err(format!("{} is larger than {FILE_MAX} bytes", path.display()));
    }
    let text = std::fs::read_to_string(path);
    text.map(Some).map_err(|why| format!("cannot read {}: {why}", path.display()))
}

#[cfg(test)]
mod tests {
    use std::path::PathBuf;

    use super::super::{bundled, hash};
    use super::{DEPTH_MAX, FILE_MAX, Library};

    /// A library with the messages `own/msg/N`, each with its text.
    fn library(texts: impl IntoIterator<Item = (String, String)>) -> (tempfile::TempDir, Library) {
        let folder = tempfile::tempdir().unwrap();
        let own = folder.path().join("own/msg");
        std::fs::create_dir_all(&own).unwrap();
        for (name, text) in texts {
            std::fs::write(own.join(name + ".msg"), text).unwrap();
        }
        let found = Library::new(vec![PathBuf::from(folder.path())], &[]);
        (folder, found)
    }

    /// Nested messages: the fields of `N1` have the type `N2`, and so on.
    fn levels(count: usize, fields: &str) -> (tempfile::TempDir, Library) {
        let text = |level: usize| match level {
            level if level == count => "int8 a".to_owned(),
            level => fields.replace("Inner", &format!("N{}", level + 1)),
        };
        library((1..=count).map(|level| (format!("N{level}"), text(level))))
    }

    #[test]
    fn a_type_that_is_nested_too_deep_is_refused_whatever_was_asked_for_before() {
        let (_folder, mut library) = levels(DEPTH_MAX + 1, "Inner a");
        let refused = "`own/msg/N1` is nested more than 64 deep";
        assert_eq!(library.find("own/msg/N1").unwrap_err(), refused);
        library.find("own/msg/N2").unwrap();
        assert_eq!(library.find("own/msg/N1").unwrap_err(), refused);
    }

    #[test]
    fn a_type_whose_shortest_message_is_too_long_is_refused_at_once() {
        let (_folder, mut library) = levels(DEPTH_MAX, "Inner a\nInner b");
        let refused = library.find("own/msg/N1").unwrap_err();
        assert!(refused.starts_with("the shortest message of `own/msg/N38` has 67108864 bytes"));
        library.find("own/msg/N40").unwrap();
    }

    #[test]
    fn a_file_that_is_too_long_is_refused_with_its_path() {
        let comment = |length: u64| "#".repeat(usize::try_from(length).unwrap());
        let texts = [("Long", FILE_MAX), ("Longer", FILE_MAX + 1)];
        let (folder, mut library) =
            library(texts.map(|(name, length)| (name.to_owned(), comment(length))));
        library.find("own/msg/Long").unwrap();
        let path = folder.path().join("own/msg/Longer.msg");
        let refused = format!("{} is larger than 1048576 bytes", path.display());
        assert_eq!(library.find("own/msg/Longer").unwrap_err(), refused);
        std::fs::write(path, "int8 a").unwrap();
        library.find("own/msg/Longer").unwrap();
    }

    fn described(text: &str) -> Vec<super::Message> {
        super::super::parse::file(text, "own", super::Sort::Message, "Own").unwrap()
    }

    #[test]
    fn a_description_is_believed_if_its_hash_is_the_one_that_is_announced() {
        let mut library = Library::new(Vec::new(), &[]);
        let (told, other) = (described("int8 a"), described("int8 b"));
        let wrong = "RIHS01_0";
        let refused = library.learn(told.clone(), wrong).unwrap_err();
        assert!(
            refused.starts_with("own/msg/Own is announced as RIHS01_0, and described as RIHS01_")
        );
        assert!(library.find("own/msg/Own").is_err());
        let announced = refused.rsplit(' ').next().unwrap();
        library.learn(told.clone(), announced).unwrap();
        assert_eq!(hash::rihs01(&library.find("own/msg/Own").unwrap()), announced);
        assert!(library.learn(other.clone(), announced).is_err());
        // A type in use is never replaced by another type with its name.
        let refused = library.learn(other.clone(), "").unwrap_err();
        let hash_of_other = refused.rsplit(' ').next().unwrap();
        let refused = library.learn(other, hash_of_other).unwrap_err();
        assert_eq!(refused, "its own/msg/Own is another than the one in use here");
        library.learn(told, announced).unwrap();
    }

    #[test]
    fn a_type_that_lies_in_this_program_can_be_replaced_by_that_of_its_users() {
        let mut library = Library::new(Vec::new(), &[]);
        assert!(library.is_bundled("nav2_msgs/msg/MissedWaypoint"));
        assert!(!library.is_bundled("own/msg/Own") && !library.is_bundled("no name"));
        let mut told = described("uint32 index\nuint16 other");
        told[0].name = "nav2_msgs/msg/MissedWaypoint".to_owned();
        library.find("nav2_msgs/msg/MissedWaypoint").unwrap();
        let refused = library.learn(told.clone(), "").unwrap_err();
        let announced = refused.rsplit(' ').next().unwrap();
        library.learn(told, announced).unwrap();
        let found = library.find("nav2_msgs/msg/MissedWaypoint").unwrap();
        assert_eq!(hash::rihs01(&found), announced);
    }

    /// Hashes as stated by the packages.
    #[test]
    fn hashes_of_all_bundled_types_are_those_of_their_packages() {
        let mut library = Library::new(Vec::new(), &[]);
        let stated = include_str!("../../interfaces/hashes.txt");
        let wrong: Vec<String> = stated
            .lines()
            .filter_map(|line| line.split_once(' '))
            .filter_map(|(name, hash)| {
                let found = library.find(name).map(|found| hash::rihs01(&found));
                (found.as_deref() != Ok(hash)).then(|| format!("{name}: {found:?}, not {hash}"))
            })
            .collect();
        assert_eq!(wrong, Vec::<String>::new());
        // These packages state no hashes.
        let silent = [
            "example_interfaces/",
            "moveit_msgs/",
            "nav2_msgs/",
            "object_recognition_msgs/",
            "octomap_msgs/",
            "rafcon_msgs/",
            "tf2_msgs/",
        ];
        let silent = |name: &String| silent.iter().any(|start| name.starts_with(start));
        for name in bundled::names() {
            assert!(library.find(&name).is_ok(), "{name} is incomplete");
            assert!(
                silent(&name) || stated.contains(&format!("{name} ")),
                "no hash of {name} is stated"
            );
        }
    }
}
