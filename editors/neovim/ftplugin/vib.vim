" How model files of the vibc compiler are edited: `gcc` makes a comment, and the layout is that of `vibc fmt`.
if exists('b:did_ftplugin')
  finish
endif
let b:did_ftplugin = 1
setlocal commentstring=//\ %s comments=:///,://
setlocal shiftwidth=2 tabstop=2 softtabstop=2 expandtab
setlocal suffixesadd=.vib
let b:undo_ftplugin = 'setlocal commentstring< comments< shiftwidth< tabstop< softtabstop< expandtab< suffixesadd<'
