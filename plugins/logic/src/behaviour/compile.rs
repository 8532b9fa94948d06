//! From RON to a program, with every mistake at its place.

use super::error::{BehaviourError, Reason, place_of};
use super::program::{Code, Factor, MOST_NODES, NONE, Op, Program};
use super::spec::{Consider, File, Literal, Node, Pairs, Test};
use crate::names::{Key, Names};
use crate::value::{Kind, Value};
use bevy::math::Vec3;

/// Values that the engine itself sets, which need not be declared.
const KNOWN: [(Key, Kind); 4] = [
    (Key::TARGET, Kind::Entity),
    (Key::PLACE, Kind::Vec3),
    (Key::ALERT, Kind::Float),
    (Key::HEALTH, Kind::Float),
];

/// Compiles the text of a file. `leaf` gives the number of a leaf's name.
///
/// # Errors
/// [`BehaviourError`].
pub fn compile(
    file: &str,
    text: &str,
    names: &mut Names,
    leaf: impl Fn(&str) -> Option<u16>,
) -> Result<Program, BehaviourError> {
    let parsed: File = ron::from_str(text).map_err(|error| BehaviourError {
        file: file.to_owned(),
        line: error.span.start.line,
        column: error.span.start.col,
        reason: Reason::Syntax(error.code.to_string()),
    })?;
    let mut compiler = Compiler {
        parsed: &parsed,
        names,
        leaf: &leaf,
        program: Program::default(),
        declared: Vec::new(),
        using: Vec::new(),
        depth: 0,
    };
    compiler.file().map_err(|(piece, reason)| {
        let (line, column) = place_of(text, piece);
        BehaviourError {
            file: file.to_owned(),
            line,
            column,
            reason,
        }
    })?;
    Ok(compiler.program)
}

/// A mistake, and the name that it stands at.
type Mistake<'a> = (&'a str, Reason);

struct Compiler<'a, 'b> {
    parsed: &'b File<'a>,
    names: &'b mut Names,
    leaf: &'b dyn Fn(&str) -> Option<u16>,
    program: Program,
    declared: Vec<(Key, Kind)>,
    /// Trees that are being put in, from the root on.
    using: Vec<&'a str>,
    depth: usize,
}

/// Deepest nodes below a root: as deep as RON itself reads a file.
const DEPTH: usize = 128;

/// The first name that is there twice.
fn twice<'a, T>(pairs: &Pairs<'a, T>) -> Result<(), Mistake<'a>> {
    let mut names: Vec<&str> = pairs.0.iter().map(|pair| pair.0).collect();
    names.sort_by_key(|name| (*name, name.as_ptr() as usize));
    match names.windows(2).find(|pair| pair[0] == pair[1]) {
        Some(pair) => Err((pair[1], Reason::Twice(pair[1].to_owned()))),
        None => Ok(()),
    }
}

impl<'a> Compiler<'a, '_> {
    fn file(&mut self) -> Result<(), Mistake<'a>> {
        let parsed = self.parsed;
        twice(&parsed.values)?;
        twice(&parsed.trees)?;
        for (name, literal) in &parsed.values.0 {
            let key = self.names.intern(name);
            let value = self.value(name, literal)?;
            if let Some((_, kind)) = KNOWN.iter().find(|(known, _)| *known == key) {
                same_kind(name, *kind, value.kind())?;
            }
            self.declared.push((key, value.kind()));
            self.program.start.push((key, value));
        }
        self.declared.extend(KNOWN);
        if !(parsed.stay.is_finite() && parsed.stay >= 0.0) {
            return Err((parsed.root, range("stay", "a number that is not below 0")));
        }
        self.program.stay = parsed.stay;
        self.tree(parsed.root, NONE)?;
        // Trees that nobody uses are held to the same rules; a loop among them is one as well.
        let used = self.program.clone();
        for (name, _) in &parsed.trees.0 {
            // Each is a program of its own: what there is room for is counted anew. Slots are bounded by nodes, which
            // have one each at most.
            self.program.nodes.clear();
            self.program.factors.clear();
            self.program.parameters.clear();
            self.program.slots = 0;
            self.tree(name, NONE)?;
        }
        self.program = used;
        Ok(())
    }

    fn tree(&mut self, name: &'a str, parent: u16) -> Result<(), Mistake<'a>> {
        if let Some(at) = self.using.iter().position(|using| *using == name) {
            let mut way: Vec<String> = self.using[at..].iter().map(|s| (*s).to_owned()).collect();
            way.push(name.to_owned());
            return Err((name, Reason::Loop(way)));
        }
        let parsed = self.parsed;
        let tree = parsed.trees.0.iter().find(|tree| tree.0 == name);
        let (at, node) = tree.ok_or_else(|| (name, Reason::UnknownTree(name.to_owned())))?;
        self.using.push(name);
        let result = self.node(at, node, parent);
        self.using.pop();
        result
    }

    fn push(&mut self, at: &'a str, op: Op, parent: u16) -> Result<u16, Mistake<'a>> {
        let number = self.program.nodes.len();
        if number >= MOST_NODES {
            return Err((at, Reason::TooLarge(MOST_NODES)));
        }
        self.program.nodes.push(Code {
            op,
            end: number as u16 + 1,
            parent,
            factors: [0; 2],
        });
        Ok(number as u16)
    }

    fn close(&mut self, node: u16) {
        self.program.nodes[usize::from(node)].end = self.program.nodes.len() as u16;
    }

    fn slot(&mut self) -> u16 {
        self.program.slots += 1;
        self.program.slots - 1
    }

    fn children(
        &mut self,
        at: &'a str,
        what: &'static str,
        op: Op,
        parent: u16,
        nodes: &[Node<'a>],
    ) -> Result<(), Mistake<'a>> {
        if nodes.is_empty() {
            return Err((at, Reason::Empty(what)));
        }
        let number = self.push(at, op, parent)?;
        for node in nodes {
            self.node(at, node, number)?;
        }
        self.close(number);
        Ok(())
    }

    fn child(
        &mut self,
        at: &'a str,
        op: Op,
        parent: u16,
        node: &Node<'a>,
    ) -> Result<(), Mistake<'a>> {
        let number = self.push(at, op, parent)?;
        self.node(at, node, number)?;
        self.close(number);
        Ok(())
    }

    /// `at` is the nearest name before a node that has none.
    fn node(&mut self, at: &'a str, node: &Node<'a>, parent: u16) -> Result<(), Mistake<'a>> {
        if self.depth == DEPTH {
            return Err((at, Reason::TooDeep(DEPTH)));
        }
        self.depth += 1;
        let result = self.inner_node(at, node, parent);
        self.depth -= 1;
        result
    }

    fn inner_node(&mut self, at: &'a str, node: &Node<'a>, parent: u16) -> Result<(), Mistake<'a>> {
        match node {
            Node::Sequence(nodes) => self.children(at, "Sequence", Op::Sequence, parent, nodes),
            Node::Select(nodes) => self.children(at, "Select", Op::Select, parent, nodes),
            Node::Choose(nodes) => self.choose(at, parent, nodes),
            Node::Not(node) => self.child(at, Op::Not, parent, node),
            Node::Anyway(node) => self.child(at, Op::Anyway, parent, node),
            Node::Repeat(node) => self.child(at, Op::Repeat, parent, node),
            Node::Cooldown(seconds, node) => {
                seconds_of(at, "Cooldown", *seconds)?;
                let slot = self.slot();
                self.child(at, Op::Cooldown(*seconds, slot), parent, node)
            }
            Node::Limit(seconds, node) => {
                seconds_of(at, "Limit", *seconds)?;
                let slot = self.slot();
                self.child(at, Op::Limit(*seconds, slot), parent, node)
            }
            Node::Wait(seconds) => {
                seconds_of(at, "Wait", *seconds)?;
                self.push(at, Op::Wait(*seconds), parent).map(drop)
            }
            Node::If(name, test) => {
                let op = self.test(name, test)?;
                self.push(name, op, parent).map(drop)
            }
            Node::Set(name, literal) => {
                let (key, kind) = self.known(name)?;
                let value = self.value(name, literal)?;
                same_kind(name, kind, value.kind())?;
                self.push(name, Op::Set(key, value), parent).map(drop)
            }
            Node::Send(verb, target) => {
                let (key, kind) = self.known(target)?;
                same_kind(target, Kind::Entity, kind)?;
                let verb_key = self.names.intern(verb);
                self.push(verb, Op::Send(verb_key, key), parent).map(drop)
            }
            Node::Say(name) => {
                let key = self.names.intern(name);
                self.push(name, Op::Say(key), parent).map(drop)
            }
            Node::Do(name) => self.leaf(name, &Pairs::default(), parent),
            Node::DoWith(name, parameters) => self.leaf(name, parameters, parent),
            Node::Use(name) => self.tree(name, parent),
        }
    }

    fn choose(
        &mut self,
        at: &'a str,
        parent: u16,
        nodes: &[(Vec<Consider<'a>>, Node<'a>)],
    ) -> Result<(), Mistake<'a>> {
        if nodes.is_empty() {
            return Err((at, Reason::Empty("Choose")));
        }
        let number = self.push(at, Op::Choose, parent)?;
        for (factors, node) in nodes {
            let from = self.program.factors.len();
            for factor in factors {
                let factor = match factor {
                    Consider::Always(score) if !score.is_finite() => {
                        return Err((at, Reason::NotFinite("Always".to_owned())));
                    }
                    Consider::Always(score) => Factor::Always(*score),
                    Consider::Of(name, curve) => {
                        let (key, _) = self.known(name)?;
                        match curve.check() {
                            (false, _) => {
                                return Err((name, Reason::NotFinite((*name).to_owned())));
                            }
                            (true, false) => {
                                let needs = "a curve whose second number is above the first, or 0";
                                return Err((name, range(name, needs)));
                            }
                            (true, true) => Factor::Of(key, *curve),
                        }
                    }
                };
                self.program.factors.push(factor);
            }
            let to = self.program.factors.len();
            if to > usize::from(u16::MAX) {
                return Err((at, Reason::TooLarge(usize::from(u16::MAX))));
            }
            let child = self.program.nodes.len();
            self.node(at, node, number)?;
            self.program.nodes[child].factors = [from as u16, to as u16];
        }
        self.close(number);
        Ok(())
    }

    fn leaf(
        &mut self,
        name: &'a str,
        parameters: &Pairs<'a, Literal<'a>>,
        parent: u16,
    ) -> Result<(), Mistake<'a>> {
        let leaf = (self.leaf)(name);
        let leaf = leaf.ok_or_else(|| (name, Reason::UnknownLeaf(name.to_owned())))?;
        twice(parameters)?;
        let from = self.program.parameters.len();
        for (name, literal) in &parameters.0 {
            let value = self.value(name, literal)?;
            let key = self.names.intern(name);
            self.program.parameters.push((key, value));
        }
        let to = self.program.parameters.len();
        if to > usize::from(u16::MAX) {
            return Err((name, Reason::TooLarge(usize::from(u16::MAX))));
        }
        let op = Op::Do(leaf, [from as u16, to as u16]);
        self.push(name, op, parent).map(drop)
    }

    fn test(&mut self, name: &'a str, test: &Test<'a>) -> Result<Op, Mistake<'a>> {
        let (key, kind) = self.known(name)?;
        let number = |x: f32| {
            let finite = x.is_finite().then_some(x);
            finite.ok_or_else(|| (name, Reason::NotFinite(name.to_owned())))
        };
        Ok(match test {
            Test::Above(x) => Op::Above(key, number(*x)?),
            Test::Below(x) => Op::Below(key, number(*x)?),
            Test::Is(literal) => {
                let value = self.value(name, literal)?;
                same_kind(name, kind, value.kind())?;
                Op::Is(key, value)
            }
            Test::Known => Op::Known(key),
            Test::Unknown => Op::Unknown(key),
        })
    }

    fn known(&mut self, name: &'a str) -> Result<(Key, Kind), Mistake<'a>> {
        let key = self.names.find(name);
        let declared = key.and_then(|key| self.declared.iter().find(|known| known.0 == key));
        declared
            .copied()
            .ok_or_else(|| (name, Reason::UnknownValue(name.to_owned())))
    }

    fn value(&mut self, name: &'a str, literal: &Literal<'a>) -> Result<Value, Mistake<'a>> {
        let value = match *literal {
            Literal::Bool(yes) => Value::Bool(yes),
            Literal::Int(n) => Value::Int(n),
            Literal::Float(x) => Value::Float(x),
            Literal::Vec3((x, y, z)) => Value::Vec3(Vec3::new(x, y, z)),
            Literal::Name(text) => Value::Key(self.names.intern(text)),
        };
        match value.is_finite() {
            true => Ok(value),
            false => Err((name, Reason::NotFinite(name.to_owned()))),
        }
    }
}

fn same_kind(name: &str, has: Kind, given: Kind) -> Result<(), Mistake<'_>> {
    if has == given {
        return Ok(());
    }
    let reason = Reason::Kind {
        name: name.to_owned(),
        has: format!("{has:?}"),
        given: format!("{given:?}"),
    };
    Err((name, reason))
}

fn range(name: &str, needs: &'static str) -> Reason {
    Reason::Range {
        name: name.to_owned(),
        needs,
    }
}

fn seconds_of<'a>(at: &'a str, name: &str, seconds: f32) -> Result<(), Mistake<'a>> {
    if !seconds.is_finite() {
        return Err((at, Reason::NotFinite(name.to_owned())));
    }
    match seconds > 0.0 {
        true => Ok(()),
        false => Err((at, range(name, "a time above 0"))),
    }
}
