// The tree-sitter grammar of the .vib language, for editors: spec.md section 1, after grammar/vib.pest.
//
// It reads every model that the compiler reads, and some more: line ends are blanks here. Nothing is lost by that in a
// model without mistakes, since each declaration begins with a keyword and nothing goes on with a word after a line end.
// The unit of a number is the exception (`10` and `force` in the next line); src/scanner.c reads it.

const LETTER = 'a-zA-Z_\\u0391-\\u03C9\\u03D0-\\u03D6\\u03F0-\\u03F5\\u00B5';

/** @param {RuleOrLiteral} rule */
const list = (rule) => seq(rule, repeat(seq(',', rule)));

module.exports = grammar({
  name: 'vib',
  word: ($) => $.word,
  extras: ($) => [/\s/, $.comment, $.documentation],
  // The second one is nowhere in the grammar: it is expected only while tree-sitter recovers from an error.
  externals: ($) => [$.unit, $._recovery],
  supertypes: ($) => [$.declaration, $.expression],

  rules: {
    file: ($) => repeat($.declaration),

    declaration: ($) => choice(
      $.model, $.parameter, $.gravity, $.point, $.body, $.base, $.element, $.joint, $.slide, $.couple,
      $.force, $.torque, $.unbalance, $.initial, $.output, $.damping, $.rest, $.solve, $.optimum, $.require, $.correlate, $.repeat,
      $.component, $.placed, $.use,
    ),

    model: ($) => seq('model', field('name', $.word)),
    parameter: ($) => choice(
      seq('param', field('name', $.name), '=', $.expression, optional($._spread), optional($._within)),
      seq('let', field('name', $.name), '=', $.expression),
    ),
    _spread: ($) => seq('spread', choice('uniform', seq(optional('lognormal'), $.expression))),
    _within: ($) => seq('within', choice($.expression, $._range)),
    correlate: ($) => seq('correlate', $._path, ',', $._path, $.expression),
    gravity: ($) => seq('gravity', $.expression),
    point: ($) => seq('point', field('name', $.name), '=', $.expression),
    body: ($) => seq('body', field('name', $.name), $.fields),
    base: ($) => seq('base', field('name', $.name), $.fields, optional($._signal)),
    element: ($) => seq(choice('spring', 'damper', 'inerter', 'belt'), field('name', $.name), ':', $.end, '--', $.end, $.fields),
    joint: ($) => seq(choice('pivot', 'weld'), field('name', $.name), ':', $.end, '--', $.end),
    slide: ($) => seq('slide', field('name', $.name), ':', $.end, '--', $.end, optional($._along)),
    couple: ($) => seq('couple', field('name', $.name), ':', $.expression, '=', $.expression),
    force: ($) => seq(
      'force', field('name', $.name), ':', $.end, optional(seq('--', $.end)), optional($._along), optional($._signal),
    ),
    torque: ($) => seq(
      'torque', field('name', $.name), ':', $.end, optional(seq('--', $.end)), optional($._signal),
    ),
    unbalance: ($) => seq('unbalance', field('name', $.name), ':', $.end, $.fields),
    initial: ($) => seq('initial', $._path, $.fields),
    output: ($) => seq(
      'output', field('name', $.name), optional(seq('in', alias($.dimension, $.unit))), '=', $.expression,
    ),
    damping: ($) => seq('damping', choice(seq('modal', $.expression), seq('rayleigh', $.group))),
    rest: (_) => seq('rest', 'as', 'drawn'),
    optimum: ($) => seq(
      choice('minimise', 'maximise'), $.expression, 'over', $.varied, repeat(seq(',', $.varied)),
      optional(seq('while', $.expression, repeat(seq(',', $.expression)))),
    ),
    varied: ($) => seq($._path, 'in', $._range),
    solve: ($) => seq('solve', $._path, 'in', $._range, ':', $.expression, '=', $.expression),
    require: ($) => seq('require', $.expression),
    repeat: ($) => seq('repeat', field('index', $.word), 'in', $._range, '{', repeat($.declaration), '}'),

    component: ($) => seq('component', field('name', $.word), $.formals, '{', repeat($.declaration), '}'),
    formals: ($) => seq('(', optional(list(choice($.port, $.formal))), ')'),
    port: ($) => seq('part', field('name', $.word)),
    formal: ($) => seq(
      field('name', $.word), optional(seq(':', $.dimension)), optional(seq('=', $.expression)),
    ),
    dimension: (_) => new RegExp(`1|/?[${LETTER}%°][${LETTER}%°0-9*/^²³·⋅-]*`),
    placed: ($) => seq(
      'place', field('name', $.name), '=', field('component', $.word), $.actuals,
      repeat(choice(seq('at', $.expression), seq('turned', $.expression), seq('mirrored', $.word))),
    ),
    actuals: ($) => seq('(', optional(list($.actual)), ')'),
    actual: ($) => seq(field('name', $.word), '=', $.expression),
    use: ($) => seq('use', $.text),

    // ---- Parts of declarations

    // `m[i-1]`, `net[i][j]`, `net[i, j]`
    name: ($) => prec(1, seq($.word, repeat($._index))),
    _index: ($) => seq(token.immediate('['), list($.expression), ']'),
    // A name, or one in a component at its place: `front.wheel`
    _path: ($) => seq($.name, repeat(seq(token.immediate('.'), $.name))),
    // `block`, `block@A`, `ground@(0, 1 m)`, `front.wheel@front.hub`
    end: ($) => seq($._path, optional(seq('@', choice($._path, $.group)))),
    _along: ($) => seq('along', $.expression),
    _signal: ($) => seq('=', $.expression),
    _range: ($) => seq($.expression, '..', $.expression),
    fields: ($) => seq('{', repeat(seq(choice($.assignment, $.moves, $.flag), optional(','))), '}'),
    assignment: ($) => seq(field('name', $.word), '=', $.expression, optional(seq('about', $.expression))),
    moves: ($) => seq('moves', choice($._along, repeat1(alias(choice('x', 'y'), $.axis)))),
    flag: ($) => $.word,

    // ---- Expressions, from loose to tight (spec.md#expressions)

    expression: ($) => choice(
      $.comparison, $.path, $.sum, $.product, $.minus, $.power,
      $.literal, $.text, $.group, $.name, $.call, $.place, $.member,
    ),
    comparison: ($) => prec.left(1, seq($.expression, choice('<', '<=', '>', '>=', '=='), $.expression)),
    path: ($) => prec.left(2, seq($.expression, '->', $.expression)),
    sum: ($) => prec.left(3, seq($.expression, choice('+', '-'), $.expression)),
    product: ($) => prec.left(4, seq($.expression, choice('*', '/'), $.expression)),
    minus: ($) => prec(5, seq('-', $.expression)),
    power: ($) => prec.right(6, seq($.expression, '^', $.expression)),

    call: ($) => seq(field('function', $.word), token.immediate('('), optional(list($._argument)), ')'),
    _argument: ($) => choice($.expression, $.named, $.white, $.range),
    // `speed = 20 m/s`
    named: ($) => seq(field('name', $.word), '=', $.expression),
    // `white 3 N^2/Hz`, of a noise; `white - 3` is a difference
    white: ($) => seq($.word, $.expression),
    // `1 Hz .. 50 Hz`
    range: ($) => $._range,
    group: ($) => seq('(', list($.expression), ')'),
    // Of a part: `rod@A`, `rod.angle`, `rod@(0, 1 m).x`
    place: ($) => prec.left(7, seq(choice($.name, $.call, $.place, $.member), '@', choice($.name, $.group))),
    member: ($) => prec.left(7, seq(choice($.name, $.call, $.place, $.member), token.immediate('.'), field('member', $.name))),

    literal: ($) => seq($.number, optional($.unit)),
    number: (_) => /(\d+(\.\d+)?|\.\d+)([eE][+-]?\d+)?/,
    text: (_) => /"[^"\n]*"/,
    word: (_) => new RegExp(`[${LETTER}][${LETTER}0-9]*`),

    comment: (_) => token(choice(/\/\/([^\/\r\n][^\r\n]*)?/, /\/\/\/\/[^\r\n]*/)),
    documentation: (_) => /\/\/\/([^\/\r\n][^\r\n]*)?/,
  },
});
