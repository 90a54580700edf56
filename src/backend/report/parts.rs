//! What a model was taken for: its independent parts with the modes of each, and, where it is asked for, what was kept of it,
//! what was left out, and why.

use super::super::counted_names;
use super::table::{Align, Table};
use super::{INDENT, line};
use crate::analysis::{Net, NetForm, nets, parts_of_modes};
use crate::answers::ModalAnswer;
use crate::lower::{Account, Remark};
use crate::system::LinearSystem;

/// Parts and remarks that are listed; the JSON has all.
const MOST: usize = 12;

/// The independent parts, where there is more than one: a line for each.
pub fn parts(answer: &ModalAnswer) -> String {
    let nets = nets(&answer.system);
    if nets.len() < 2 {
        return String::new();
    }
    let mut modes: Vec<Vec<String>> = vec![Vec::new(); nets.len()];
    for ((number, _), part) in answer.modes.numbered().zip(parts_of_modes(&nets, &answer.modes.list)) {
        modes[part].push(number.to_string());
    }
    let columns = [("part", Align::Right), ("what", Align::Left), ("coordinates", Align::Left), ("modes", Align::Left)];
    let mut table = columns.into_iter().fold(Table::new(), |table, (title, align)| table.column(title, "", align));
    for (number, (net, modes)) in (1..).zip(nets.iter().zip(modes)).take(MOST) {
        table.row(vec![number.to_string(), told(net), names(&answer.system, net), counted_names(&modes)]);
    }
    let mut text = line(format!("falls into {} parts that do not act on each other", nets.len())) + &table.text(INDENT);
    if nets.len() > MOST {
        text += &line(format!("... and {} more (--format json has all)", nets.len() - MOST));
    }
    text
}

fn told(net: &Net) -> String {
    let n = net.coordinates.len();
    match net.form {
        NetForm::Free => "free: nothing acts on it".into(),
        NetForm::Single => "one freedom".into(),
        NetForm::Chain => format!("chain of {n}"),
        NetForm::Tree => format!("tree of {n}"),
        NetForm::Band { width } => format!("band of {n}, {width} wide"),
        NetForm::Linkage => format!("linkage of {n}, kept as chained rows"),
        NetForm::General => format!("{n} freedoms"),
    }
}

fn names(system: &LinearSystem, net: &Net) -> String {
    let shown = net.coordinates.iter().take(4);
    let names: Vec<String> = shown.map(|i| system.display(system.coordinates[i.index()].name)).collect();
    match net.coordinates.len() {
        4.. if net.coordinates.len() > 4 => format!("{}, ...", names[..3].join(", ")),
        _ => names.join(", "),
    }
}

/// What was kept and what was left out.
pub fn explained(account: &Account, system: &LinearSystem) -> String {
    let mut text = remarks("kept", &account.kept);
    text += &if account.left_out.is_empty() {
        line("left out: nothing")
    } else {
        remarks("left out, for it changes nothing", &account.left_out)
    };
    if let [net] = &nets(system)[..] {
        text += &line(format!("one part: {} ({})", told(net), names(system, net)));
    }
    text
}

/// The same with the parts, where there is no more to report.
pub fn explanation(account: &Account, system: &LinearSystem) -> String {
    let mut text = explained(account, system);
    let nets = nets(system);
    if nets.len() > 1 {
        text += &line(format!("falls into {} parts that do not act on each other", nets.len()));
    }
    for (number, net) in (1..).zip(&nets).take(if nets.len() > 1 { MOST } else { 0 }) {
        text += &line(format!("  part {number}: {} ({})", told(net), names(system, net)));
    }
    if nets.len() > MOST {
        text += &line(format!("  ... and {} more", nets.len() - MOST));
    }
    text
}

fn remarks(title: &str, remarks: &[Remark]) -> String {
    let mut table = Table::new().column(title, "", Align::Left).column("why", "", Align::Left);
    for remark in remarks.iter().take(MOST) {
        table.row(vec![remark.what.clone(), remark.why.clone()]);
    }
    let mut text = table.text(INDENT);
    if remarks.len() > MOST {
        text += &line(format!("... and {} more (--format json has all)", remarks.len() - MOST));
    }
    text
}
