//! The parts of a model: its independent parts with the modes of each and, on request, the parts of the model that were
//! kept and left out, and why.

use super::table::{Align, Table};
use super::{Block, Line, Report, Section, coordinate, enumeration, first_of, line};
use crate::analysis::{Net, NetForm, nets, parts_of_modes};
use crate::answers::ModalAnswer;
use crate::lower::{Account, Remark};
use crate::system::LinearSystem;

/// Number of parts and remarks that are listed; the JSON has all.
const MOST: usize = 12;
/// Number of modes, and of coordinates' names, that are listed for a part.
const MOST_MODES: usize = 6;
const MOST_NAMES: usize = 3;
const HEADING: &str = "Independent parts";

/// The independent parts, if there is more than one, with a row for each.
pub fn section(answer: &ModalAnswer) -> Section {
    let nets = nets(&answer.system);
    if nets.len() < 2 {
        return Section::new(HEADING, []);
    }
    let mut modes: Vec<Vec<Line>> = vec![Vec::new(); nets.len()];
    for ((number, _), part) in answer.modes.with_numbers().zip(parts_of_modes(&nets, &answer.modes.list)) {
        modes[part].push(number.into());
    }
    let mut table = Table::of([
        ("part", Align::Right),
        ("what", Align::Left),
        ("coordinates", Align::Left),
        ("modes", Align::Left),
    ]);
    for (number, (net, modes)) in (1..).zip(nets.iter().zip(modes)).take(MOST) {
        let modes = first_of(modes, MOST_MODES);
        table.row(vec![number.into(), form(net).into(), names(&answer.system, net).into(), modes.into()]);
    }
    let more = nets.len().checked_sub(MOST).filter(|more| *more > 0);
    let more = more.map(|more| line!["... and ", more, " (--format json has all)"]);
    let blocks = [falls_into(nets.len()).into(), table.into()];
    Section::new(HEADING, blocks.into_iter().chain(more.map(Block::from)))
}

fn falls_into(parts: usize) -> Line {
    line!["falls into ", parts, " independent parts"]
}

fn form(net: &Net) -> Line {
    let n = net.coordinates.len();
    match net.form {
        NetForm::Free => "free: nothing acts on it".into(),
        NetForm::Single => "one degree of freedom".into(),
        NetForm::Chain => line!["chain of ", n],
        NetForm::Tree => line!["tree of ", n],
        NetForm::Band { width } => line!["band of ", n, ", ", width, " wide"],
        NetForm::Linkage => line!["linkage of ", n, ", kept as chained rows"],
        NetForm::General => line![n, " degrees of freedom"],
    }
}

fn names(system: &LinearSystem, net: &Net) -> Line {
    let name = |i: &crate::system::CoordinateId| Line::from(coordinate(system, &system.coordinates[i.index()]));
    match net.coordinates.len() {
        n if n > MOST_NAMES + 1 => line![enumeration(net.coordinates[..MOST_NAMES].iter().map(name)), ", ..."],
        _ => enumeration(net.coordinates.iter().map(name)),
    }
}

/// The parts of the model that were kept and left out.
pub fn account_section(account: &Account, system: &LinearSystem) -> Section {
    let mut blocks = remarks("kept", &account.kept);
    if account.left_out.is_empty() {
        blocks.push(Block::Line("left out: nothing".into()));
    } else {
        blocks.extend(remarks("left out, because it changes nothing", &account.left_out));
    }
    if let [net] = &nets(system)[..] {
        blocks.push(line!["one part: ", form(net), " (", names(system, net), ")"].into());
    }
    Section::new("What was kept of the model", blocks)
}

/// The parts of a model that were kept and left out, for runs without another report.
pub fn explanation(model: &str, account: &Account, system: &LinearSystem) -> Report {
    let mut section = account_section(account, system);
    let nets = nets(system);
    if nets.len() > 1 {
        section.blocks.push(falls_into(nets.len()).into());
        for (number, net) in (1..).zip(&nets).take(MOST) {
            let part = line!["part ", number, ": ", form(net), " (", names(system, net), ")"];
            section.blocks.push(Block::Item(part));
        }
    }
    if nets.len() > MOST {
        section.blocks.push(Block::Item(line!["... and ", nets.len() - MOST, " more"]));
    }
    Report::new(line![model.to_string()], [section])
}

fn remarks(title: &'static str, remarks: &[Remark]) -> Vec<Block> {
    let mut table = Table::of([(title, Align::Left), ("why", Align::Left)]);
    for remark in remarks.iter().take(MOST) {
        table.row(vec![remark.what.clone().into(), remark.why.clone().into()]);
    }
    let more = remarks.len().saturating_sub(MOST);
    let more = (more > 0).then(|| Block::Line(line!["... and ", more, " more (--format json has all)"]));
    [table.into()].into_iter().chain(more).collect()
}
