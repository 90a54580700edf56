//! A formula in its final layout: leading factors, brackets, fractions. Each back end writes it in its own language.

use crate::base::Rational;
use crate::equations::names::Label;

/// A formula. Numbers are not negative: signs belong to sums.
#[derive(Clone, Debug, PartialEq)]
pub enum Formula {
    Number(Rational),
    Pi,
    /// The root of -1.
    Imaginary,
    Name(Label),
    /// Terms with their signs; `true` means minus.
    Sum(Vec<(bool, Formula)>),
    Product(Vec<Formula>),
    Quotient(Box<Formula>, Box<Formula>),
    Power(Box<Formula>, u32),
    Root(Box<Formula>),
    /// A function with its arguments.
    Call(&'static str, Vec<Formula>),
    /// An upright capital of a matrix, an energy or a vector.
    Symbol(&'static str, Option<Box<Formula>>),
    Matrix(Vec<Vec<Formula>>),
    /// A sum over a running index.
    Series(Running, Box<Formula>),
    /// `left = right`
    Equal(Box<Formula>, Box<Formula>),
    /// A number that has been rounded, as decimal text.
    Decimal(String),
}

/// An index that runs over whole numbers.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Running {
    pub index: String,
    pub first: i64,
    pub last: i64,
}

impl Formula {
    pub fn zero() -> Formula {
        Formula::Number(Rational::ZERO)
    }

    pub fn negate(self) -> Formula {
        Formula::Sum(vec![(true, self)])
    }

    pub fn equal(self, right: Formula) -> Formula {
        Formula::Equal(Box::new(self), Box::new(right))
    }

    /// A sum of terms with signs; a single positive term is returned as it is.
    pub fn sum(mut terms: Vec<(bool, Formula)>) -> Formula {
        match &terms[..] {
            [] => Formula::zero(),
            [(false, _)] => terms.swap_remove(0).1,
            _ => Formula::Sum(terms),
        }
    }

    /// A product; factors of one are omitted.
    pub fn product(factors: Vec<Formula>) -> Formula {
        let mut flat = Vec::new();
        for factor in factors {
            match factor {
                Formula::Product(inner) => flat.extend(inner),
                Formula::Number(number) if number.is_one() => {}
                other => flat.push(other),
            }
        }
        // x/r, not 1/r x.
        let is_inverse = |factor: &Formula| matches!(factor, Formula::Quotient(over, _) if matches!(&**over, Formula::Number(one) if one.is_one()));
        if flat.len() > 1
            && let Some(place) = flat.iter().position(is_inverse)
            && let Formula::Quotient(_, under) = flat.remove(place)
        {
            return Formula::Quotient(Box::new(Formula::product(flat)), under);
        }
        match flat.len() {
            0 => Formula::Number(Rational::ONE),
            1 => flat.swap_remove(0),
            _ => Formula::Product(flat),
        }
    }

    pub fn quotient(over: Formula, under: Formula) -> Formula {
        match &under {
            Formula::Number(number) if number.is_one() => over,
            _ => Formula::Quotient(Box::new(over), Box::new(under)),
        }
    }
}

/// The usual notation of a number: an integer, a fraction of small numbers, or a decimal; otherwise a fraction.
pub enum Shown {
    Whole(String),
    Fraction(String, String),
}

/// Denominators of fractions that are written as fractions even if they have a finite decimal.
const FRACTIONS: [i64; 9] = [2, 3, 4, 6, 8, 9, 12, 16, 24];
/// The most digits of a decimal that is easy to read.
const MOST_DIGITS: usize = 9;

/// The numerator and denominator with which a coefficient is written: (9.81, 1) for 981/100, (2, 3) for 2/3.
pub fn as_shown(number: &Rational) -> Shown {
    let Some((numerator, denominator)) = number.to_fraction() else {
        let big = number.to_big();
        return Shown::Fraction(big.numer().to_string(), big.denom().to_string());
    };
    if denominator == 1 {
        return Shown::Whole(numerator.to_string());
    }
    match decimal(numerator, denominator) {
        Some(text) if !FRACTIONS.contains(&denominator) => Shown::Whole(text),
        _ => Shown::Fraction(numerator.to_string(), denominator.to_string()),
    }
}

/// The exact decimal of a fraction, if it is short.
fn decimal(numerator: i64, denominator: i64) -> Option<String> {
    let (mut power, mut places) = (1i64, 0usize);
    while power % denominator != 0 {
        power = power.checked_mul(10)?;
        places += 1;
        if places > MOST_DIGITS {
            return None;
        }
    }
    let scaled = numerator.checked_mul(power / denominator)?;
    let digits = format!("{:0width$}", scaled.unsigned_abs(), width = places + 1);
    let (whole, part) = digits.split_at(digits.len() - places);
    Some(format!("{}{whole}.{part}", if scaled < 0 { "-" } else { "" }))
}

/// Greek letters by name and character.
const GREEK: [(&str, char); 48] = [
    ("Alpha", 'Α'),
    ("Beta", 'Β'),
    ("Gamma", 'Γ'),
    ("Delta", 'Δ'),
    ("Epsilon", 'Ε'),
    ("Zeta", 'Ζ'),
    ("Eta", 'Η'),
    ("Theta", 'Θ'),
    ("Iota", 'Ι'),
    ("Kappa", 'Κ'),
    ("Lambda", 'Λ'),
    ("Mu", 'Μ'),
    ("Nu", 'Ν'),
    ("Xi", 'Ξ'),
    ("Omicron", 'Ο'),
    ("Pi", 'Π'),
    ("Rho", 'Ρ'),
    ("Sigma", 'Σ'),
    ("Tau", 'Τ'),
    ("Upsilon", 'Υ'),
    ("Phi", 'Φ'),
    ("Chi", 'Χ'),
    ("Psi", 'Ψ'),
    ("Omega", 'Ω'),
    ("alpha", 'α'),
    ("beta", 'β'),
    ("gamma", 'γ'),
    ("delta", 'δ'),
    ("epsilon", 'ε'),
    ("zeta", 'ζ'),
    ("eta", 'η'),
    ("theta", 'θ'),
    ("iota", 'ι'),
    ("kappa", 'κ'),
    ("lambda", 'λ'),
    ("mu", 'μ'),
    ("nu", 'ν'),
    ("xi", 'ξ'),
    ("omicron", 'ο'),
    ("pi", 'π'),
    ("rho", 'ρ'),
    ("sigma", 'σ'),
    ("tau", 'τ'),
    ("upsilon", 'υ'),
    ("phi", 'φ'),
    ("chi", 'χ'),
    ("psi", 'ψ'),
    ("omega", 'ω'),
];

/// The name of a Greek letter, from its name or character; variants map to the basic letter.
pub fn greek_name(word: &str) -> Option<&'static str> {
    let mut characters = word.chars();
    let single = characters.next().filter(|_| characters.next().is_none()).map(|c| match c {
        'ς' => 'σ',
        'ϑ' => 'θ',
        'ϕ' => 'φ',
        'ϵ' => 'ε',
        'ϖ' => 'π',
        'ϰ' => 'κ',
        'ϱ' => 'ρ',
        'µ' => 'μ',
        other => other,
    });
    GREEK.iter().find(|(name, letter)| *name == word || single == Some(*letter)).map(|(name, _)| *name)
}

/// The character of a Greek letter.
pub fn greek_letter(word: &str) -> Option<char> {
    let name = greek_name(word)?;
    GREEK.iter().find(|(known, _)| *known == name).map(|(_, letter)| *letter)
}
