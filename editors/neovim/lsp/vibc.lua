-- The language server, for Neovim 0.11 and later: `vim.lsp.enable('vibc')` in init.lua starts it for model files.
return {
  cmd = { 'vibc', 'lsp' },
  filetypes = { 'vib' },
  root_markers = { '.git' },
}
