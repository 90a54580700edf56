" Colours for model files of the vibc compiler.
if exists('b:current_syntax')
  finish
endif
syntax match vibComment '//.*$'
syntax match vibDoc '///.*$'
syntax keyword vibKeyword model param let gravity point body base pivot slide weld couple spring damper force torque
syntax keyword vibKeyword initial output damping repeat solve require rest as drawn in along about moves turns free modal stable
syntax keyword vibConstant ground pi
syntax match vibNumber '\<\d\+\(\.\d\+\)\?\([eE][+-]\?\d\+\)\?'
syntax region vibString start='"' end='"' oneline
syntax match vibOperator '--\|->\|\.\.\|<=\|>='
highlight default link vibComment Comment
highlight default link vibDoc SpecialComment
highlight default link vibKeyword Keyword
highlight default link vibConstant Constant
highlight default link vibNumber Number
highlight default link vibString String
highlight default link vibOperator Operator
let b:current_syntax = 'vib'
