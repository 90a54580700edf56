" :compiler vibc, then :make fills the quickfix list with what `vibc check` finds.
let current_compiler = 'vibc'
CompilerSet makeprg=vibc\ check\ --message-format\ short\ %:S
CompilerSet errorformat=%f:%l:%c:\ %trror[%.%#]:\ %m,%f:%l:%c:\ %tarning[%.%#]:\ %m,%f:%l:%c:\ %tote[%.%#]:\ %m
