; Colours of model files, with the names that Helix and Neovim both know or fall back from.

(comment) @comment
(documentation) @comment.documentation
(text) @string
(number) @constant.numeric
(unit) @type

[
  "model" "param" "let" "gravity" "point" "body" "pivot" "slide" "weld" "couple" "spring" "damper" "inerter" "belt"
  "base" "force" "torque" "unbalance" "initial" "output" "damping" "rest" "repeat" "solve" "minimise" "maximise"
  "require" "correlate" "component" "place" "use"
] @keyword
["as" "drawn" "in" "along" "about" "moves" "modal" "rayleigh" "part" "at" "turned" "mirrored"
  "spread" "uniform" "lognormal" "within"] @keyword
(axis) @constant.builtin
((flag) @keyword (#any-of? @keyword "turns" "free" "crossed" "clockwise"))

(assignment name: (word) @variable.parameter)
(member member: (name (word) @variable.other.member))
(call function: (word) @function)
((call function: (word) @function.builtin)
  (#any-of? @function.builtin
    "rod" "disk" "ring" "box" "constant" "step" "impulse" "ramp" "pulse" "harmonic" "chirp" "half_sine" "haversine"
    "sawtooth" "trapezoid" "table" "periodic" "delayed" "noise" "spectrum" "frequency" "damping" "gain" "phase"
    "amplitude" "static" "peak" "settling" "overshoot" "rms" "psd" "crossings" "peak_gain" "effective_mass" "rest"
    "sqrt" "abs" "min" "max" "sin" "cos" "tan" "asin" "acos" "atan" "atan2" "exp" "ln"))

((name (word) @constant.builtin) (#any-of? @constant.builtin "ground" "pi" "stable"))
(white (word) @constant.builtin)
(parameter name: (name (word) @variable))
(model name: (word) @type)
(body name: (name (word) @type))
(base name: (name (word) @type))
(repeat index: (word) @variable)
(component name: (word) @type)
(placed component: (word) @type)
(port name: (word) @variable)
(formal name: (word) @variable)
(actual name: (word) @variable.parameter)
(dimension) @type

["--" "->" ".." "=" "==" "<" "<=" ">" ">=" "+" "-" "*" "/" "^" "@"] @operator
["(" ")" "[" "]" "{" "}"] @punctuation.bracket
["," ":" "."] @punctuation.delimiter
