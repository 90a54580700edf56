//! What nobody writes in a formula, found in the plain text of equations: each line is read into a tree of its own, and the tree is searched.

use std::iter::Peekable;
use std::str::Chars;

/// A formula as it is read: a blank multiplies, a slash divides by one factor.
#[derive(Clone, Debug, PartialEq)]
enum Tree {
    Number(String),
    Name(String),
    /// Terms with true for minus.
    Sum(Vec<(bool, Tree)>),
    Product(Vec<Tree>),
    Quotient(Box<Tree>, Box<Tree>),
    Power(Box<Tree>, Box<Tree>),
    Call(String, Vec<Tree>),
    /// Brackets, as they stand.
    Brackets(Box<Tree>),
}

/// The formulas of a text: lines that go on are joined, notes and matrices left out.
pub fn formulas(text: &str) -> Vec<String> {
    let mut formulas: Vec<String> = Vec::new();
    for line in text.lines().filter(|line| line.starts_with("    ")) {
        // Notes stand behind four blanks.
        let formula = line.trim().split("    ").next().unwrap_or_default();
        match formulas.last_mut() {
            Some(last) if line.starts_with("        ") => *last += &format!(" {formula}"),
            _ => formulas.push(formula.to_string()),
        }
    }
    formulas.retain(|formula| !formula.contains('['));
    formulas
}

/// What is wrong with a formula, each fault in words.
pub fn faults(formula: &str) -> Vec<String> {
    let mut faults = Vec::new();
    if formula.contains('?') {
        faults.push("a name that nothing says".into());
    }
    // The range of a sum has an equals sign of its own.
    for side in formula.replace(", i = ", ", i: ").split(" = ") {
        match Reader::read(side) {
            Ok(tree) => look(&tree, &mut faults),
            Err(what) => faults.push(what),
        }
    }
    faults
}

fn look(tree: &Tree, faults: &mut Vec<String>) {
    let mut say = |what: &str| faults.push(what.to_string());
    match tree {
        Tree::Number(digits) if ["0.5", "0.25", "0.75", "0.125"].contains(&digits.as_str()) => {}
        Tree::Number(_) | Tree::Name(_) => {}
        Tree::Sum(terms) => {
            if terms.len() > 1 && terms.iter().any(|(_, term)| is_number(term, "0")) {
                say("a term of zero");
            }
            let repeated = |place: usize| terms[..place].iter().any(|(_, other)| *other == terms[place].1);
            if (0..terms.len()).any(repeated) {
                say("a sum of equal terms");
            }
        }
        Tree::Product(factors) => {
            if factors.iter().any(|factor| is_number(factor, "1")) {
                say("a factor of one");
            }
            if factors.iter().any(|factor| is_number(factor, "0")) {
                say("a factor of zero");
            }
            let halves = ["0.5", "0.25", "0.75", "0.125"];
            if factors.iter().any(|factor| halves.iter().any(|half| is_number(factor, half))) {
                say("a decimal for a half, a quarter or an eighth");
            }
            if let Some(shared) = factors.iter().find_map(shared_factor) {
                faults.push(format!("{shared}, which is not taken out,"));
            }
        }
        Tree::Quotient(over, under) => {
            if holds_quotient(over) || holds_quotient(under) {
                say("a quotient of quotients");
            }
            if is_number(under, "1") {
                say("a quotient by one");
            }
            if let (Tree::Brackets(_), Some(shared)) = (&**over, shared_factor(over)) {
                faults.push(format!("{shared}, which is not taken out,"));
            }
        }
        Tree::Power(_, exponent) => {
            if is_number(exponent, "1") || is_number(exponent, "0") {
                say("a power of one or zero");
            }
        }
        Tree::Call(function, arguments) => {
            if let ("sqrt", [Tree::Sum(terms)]) = (function.as_str(), &arguments[..]) {
                let is_multiplied_out = terms.len() > 3 && !terms.iter().any(|(_, term)| is_square_of_sum(term));
                if is_multiplied_out {
                    say("a root of what has been multiplied out");
                }
            }
            let is_square = |digits: &str| digits.parse().is_ok_and(|n: u64| n.isqrt().pow(2) == n);
            if let ("sqrt", [Tree::Number(digits)]) = (function.as_str(), &arguments[..])
                && is_square(digits)
            {
                say("the root of a square");
            }
        }
        Tree::Brackets(inner) => {
            if matches!(**inner, Tree::Number(_) | Tree::Name(_) | Tree::Brackets(_)) {
                say("brackets around one thing");
            }
            if let Tree::Sum(terms) = &**inner
                && terms.iter().all(|(negative, _)| *negative)
            {
                say("a minus that belongs in front of the brackets");
            }
        }
    }
    match tree {
        Tree::Number(_) | Tree::Name(_) => {}
        Tree::Sum(terms) => terms.iter().for_each(|(_, term)| look(term, faults)),
        Tree::Product(parts) | Tree::Call(_, parts) => parts.iter().for_each(|part| look(part, faults)),
        Tree::Quotient(a, b) | Tree::Power(a, b) => [a, b].into_iter().for_each(|part| look(part, faults)),
        Tree::Brackets(inner) => look(inner, faults),
    }
}

/// `(x - a)^2` or `L^2 (1 - cos(theta))^2`.
fn is_square_of_sum(tree: &Tree) -> bool {
    match tree {
        Tree::Power(base, _) => matches!(**base, Tree::Brackets(_)),
        Tree::Product(factors) => factors.iter().any(is_square_of_sum),
        _ => false,
    }
}

fn is_number(tree: &Tree, digits: &str) -> bool {
    matches!(tree, Tree::Number(own) if own == digits)
}

/// A quotient on or under a fraction bar, not in a function.
fn holds_quotient(tree: &Tree) -> bool {
    match tree {
        Tree::Quotient(..) => true,
        Tree::Sum(terms) => terms.iter().any(|(_, term)| holds_quotient(term)),
        Tree::Product(factors) => factors.iter().any(holds_quotient),
        Tree::Power(base, _) => holds_quotient(base),
        Tree::Brackets(inner) => holds_quotient(inner),
        Tree::Number(_) | Tree::Name(_) | Tree::Call(..) => false,
    }
}

/// A name that every term of a sum in brackets has as a factor; polynomials in s are written by their coefficients.
fn shared_factor(factor: &Tree) -> Option<String> {
    let Tree::Brackets(inner) = factor else { return None };
    let Tree::Sum(terms) = &**inner else { return None };
    let mut all = terms.iter().map(|(_, term)| names(term));
    let first = all.next()?;
    if terms.len() < 2 || terms.iter().any(|(_, term)| names(term).contains(&"s".to_string())) {
        return None;
    }
    let rest: Vec<Vec<String>> = all.collect();
    first.into_iter().find(|name| rest.iter().all(|others| others.contains(name)))
}

/// The names that are multiplied in a term.
fn names(term: &Tree) -> Vec<String> {
    match term {
        Tree::Name(name) => vec![name.clone()],
        Tree::Product(factors) => factors.iter().flat_map(names).collect(),
        Tree::Quotient(over, _) => names(over),
        Tree::Power(base, _) => names(base),
        _ => Vec::new(),
    }
}

struct Reader<'a> {
    left: Peekable<Chars<'a>>,
}

impl Reader<'_> {
    fn read(text: &str) -> Result<Tree, String> {
        let mut reader = Reader { left: text.chars().peekable() };
        let tree = reader.sum()?;
        match reader.left.next() {
            None => Ok(tree),
            Some(other) => Err(format!("an unexpected `{other}`")),
        }
    }

    fn takes(&mut self, wanted: char) -> bool {
        self.left.next_if_eq(&wanted).is_some()
    }

    /// ` + ` and ` - ` between terms, a minus at the front.
    fn sum(&mut self) -> Result<Tree, String> {
        let mut terms = vec![(self.takes('-'), self.product()?)];
        while self.takes(' ') {
            let negative = match self.left.next() {
                Some('+') => false,
                Some('-') => true,
                other => return Err(format!("{other:?} for a sign")),
            };
            if !self.takes(' ') || self.left.peek() == Some(&'-') {
                return Err("two signs in a row".into());
            }
            terms.push((negative, self.product()?));
        }
        if let [(false, _)] = terms[..] {
            return Ok(terms.swap_remove(0).1);
        }
        Ok(Tree::Sum(terms))
    }

    fn product(&mut self) -> Result<Tree, String> {
        let mut factors = vec![self.power()?];
        loop {
            if self.takes('/') {
                let under = self.power()?;
                let over = if factors.len() == 1 { factors.swap_remove(0) } else { Tree::Product(factors) };
                factors = vec![Tree::Quotient(Box::new(over), Box::new(under))];
                continue;
            }
            let mut ahead = self.left.clone();
            if ahead.next() == Some(' ') && !matches!(ahead.next(), Some('+' | '-') | None) {
                self.left.next();
                factors.push(self.power()?);
                continue;
            }
            return Ok(if factors.len() == 1 { factors.swap_remove(0) } else { Tree::Product(factors) });
        }
    }

    fn power(&mut self) -> Result<Tree, String> {
        let base = self.one()?;
        if self.takes('^') {
            return Ok(Tree::Power(Box::new(base), Box::new(self.one()?)));
        }
        Ok(base)
    }

    fn one(&mut self) -> Result<Tree, String> {
        if self.takes('(') {
            let inner = self.sum()?;
            return if self.takes(')') { Ok(Tree::Brackets(Box::new(inner))) } else { Err("an open bracket".into()) };
        }
        let mut word = String::new();
        loop {
            // A comma belongs to an index, `theta_upper,0`, where something follows it at once.
            let mut ahead = self.left.clone();
            let is_index = ahead.next() == Some(',') && ahead.next().is_some_and(char::is_alphanumeric);
            let belongs = |c: &char| c.is_alphanumeric() || "_.'[]≤".contains(*c) || is_index && *c == ',';
            let Some(c) = self.left.next_if(belongs) else { break };
            word.push(c);
            // An index in brackets: y_(i-1).
            if c == '_' && self.left.peek() == Some(&'(') {
                word.extend(self.left.by_ref().take_while(|c| *c != ')'));
            }
        }
        match word.chars().next() {
            None => Err(format!("{:?} for a factor", self.left.peek())),
            Some(c) if c.is_ascii_digit() => {
                // A power of ten: 3.1e-7.
                if word.ends_with('e') && self.takes('-') {
                    word.push('-');
                    word.extend(std::iter::from_fn(|| self.left.next_if(char::is_ascii_digit)));
                }
                Ok(Tree::Number(word))
            }
            Some(_) if self.left.peek() == Some(&'(') => self.call(word),
            Some(_) => Ok(Tree::Name(word)),
        }
    }

    fn call(&mut self, function: String) -> Result<Tree, String> {
        self.takes('(');
        let mut arguments = vec![self.sum()?];
        while self.takes(',') {
            self.takes(' ');
            // The range of a sum: i = 1..4, its equals sign read as a colon.
            if function == "sum" {
                let range: String = self.left.by_ref().take_while(|c| *c != ')').collect();
                return Ok(Tree::Call(function, vec![arguments.swap_remove(0), Tree::Name(range)]));
            }
            arguments.push(self.sum()?);
        }
        if self.takes(')') { Ok(Tree::Call(function, arguments)) } else { Err("an open bracket".into()) }
    }
}

/// Each kind of fault by itself, and beside it what people write.
#[test]
fn each_fault_is_reported_and_ordinary_style_is_not() {
    for (bad, what) in [
        ("a - -b", "two signs in a row"),
        ("1 x + y", "a factor of one"),
        ("0.5 m x'^2", "a decimal for a half"),
        ("0.25 k", "a decimal for a half"),
        ("(m1 L + m2 L^2/3) x''", "L, which is not taken out"),
        ("(k L - m g L)/J", "L, which is not taken out"),
        ("m x'' + k x + k x", "a sum of equal terms"),
        ("T/l y + T/l y", "a sum of equal terms"),
        ("a/b/c", "a quotient of quotients"),
        ("sqrt((6 k L - 3 m g/2)/(m L))", "a quotient of quotients"),
        ("(300 k/89 - 75 m g/89 sin(theta_0))/(m L^2)", "a quotient of quotients"),
        ("x/1", "a quotient by one"),
        ("x^1 + y", "a power of one"),
        ("a + 0", "a term of zero"),
        ("0 x", "a factor of zero"),
        ("2 sqrt(4) k", "the root of a square"),
        ("(k) x", "brackets around one thing"),
        ("l_s = sqrt(3.17 + x^2 - 2.6 x - 1.4 sin(theta))", "a root of what has been multiplied out"),
        ("k (-x - y)", "a minus that belongs in front"),
    ] {
        let found = faults(bad).join("; ");
        assert!(found.contains(what), "{bad}: {found}");
    }
    for good in [
        "(m1 + m2) x'' + m2 L/2 cos(theta) theta'' - m2 L/2 sin(theta) theta'^2 + b x' + k x = F",
        "1/2 m x'^2 + 1/6 m2 L^2 theta'^2",
        "m y_i'' - k y_(i-1) + 2 k y_i - k y_(i+1) = 0",
        "sum(1/2 k (y_i - y_(i-1))^2, i = 2..100)",
        "5 (m + l/3) theta_left''",
        "k (1 - 1/l_left) L (L sin(theta) - cos(theta))",
        "omega_1^2 = (a_2 - sqrt(a_2^2 - 4 a_4 a_0))/(2 a_4)",
        "x/F = (2 m2 L^2 s^2 + 3 m2 g L)/(6 Delta)",
        "c_1 = 3.1e-7",
        "l_s = sqrt(L^2 (1 - cos(theta))^2 + (1 - L sin(theta))^2)",
        "l = sqrt(L^2 + a^2 - 2 L a cos(theta))",
    ] {
        let found = faults(good);
        assert!(found.is_empty(), "{good}: {found:?}");
    }
}
