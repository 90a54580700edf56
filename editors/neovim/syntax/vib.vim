" Colours for model files of the vibc compiler; the language server adds its own.
if exists('b:current_syntax')
  finish
endif
syntax match vibComment '//.*$'
syntax match vibDoc '///.*$'
syntax match vibKeyword '\(^\|{\)\s*\zs\(model\|param\|let\|gravity\|point\|body\|pivot\|slide\|weld\|couple\|spring\|damper\|inerter\|belt\|base\|force\|torque\|unbalance\|initial\|output\|damping\|rest\|repeat\|solve\|minimise\|maximise\|require\|correlate\|component\|place\|use\)\>'
syntax keyword vibWord as drawn in along about moves turns free modal
syntax keyword vibConstant ground pi stable
syntax match vibFunction '\<\(rod\|disk\|ring\|box\|constant\|step\|impulse\|ramp\|pulse\|harmonic\|chirp\|half_sine\|haversine\|sawtooth\|trapezoid\|table\|periodic\|delayed\|noise\|spectrum\|frequency\|damping\|gain\|phase\|amplitude\|static\|peak\|settling\|overshoot\|rms\|psd\|crossings\|peak_gain\|effective_mass\|rest\|rayleigh\|sqrt\|abs\|min\|max\|sin\|cos\|tan\|asin\|acos\|atan\|atan2\|exp\|ln\)(\@='
syntax match vibNumber '\<\d\+\(\.\d\+\)\?\([eE][+-]\?\d\+\)\?'
syntax region vibString start='"' end='"' oneline
syntax match vibOperator '--\|->\|\.\.\|<=\|>='
highlight default link vibComment Comment
highlight default link vibDoc SpecialComment
highlight default link vibKeyword Keyword
highlight default link vibWord Keyword
highlight default link vibConstant Constant
highlight default link vibFunction Function
highlight default link vibNumber Number
highlight default link vibString String
highlight default link vibOperator Operator
let b:current_syntax = 'vib'
