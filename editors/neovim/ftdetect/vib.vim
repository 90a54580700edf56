" Model files of the vibc compiler.
autocmd BufNewFile,BufRead *.vib setfiletype vib
