-- Neovim as a client of the language server: run as `VIBC=path/of/vibc nvim --headless --clean -l neovim.lua MODEL`.
-- It opens a model with two errors, sees both, applies a fix, renames a parameter, lays the text out and sees the
-- frequencies. Each step that fails says so and ends with status 1.

local model = arg[1]

local function step(what, condition)
  if not condition then
    io.stderr:write('failed: ' .. what .. '\n')
    vim.cmd('cquit 1')
  end
  io.stdout:write('ok: ' .. what .. '\n')
end

local function text()
  return table.concat(vim.api.nvim_buf_get_lines(0, 0, -1, false), '\n')
end

local function place(mark)
  local line, column = 0, nil
  for number, content in ipairs(vim.api.nvim_buf_get_lines(0, 0, -1, false)) do
    column = content:find(mark, 1, true)
    if column then line = number break end
  end
  assert(column, mark .. ' is not in the text')
  vim.api.nvim_win_set_cursor(0, { line, column - 1 })
end

-- The configuration that users copy, with the program that is tested.
local here = debug.getinfo(1, 'S').source:sub(2):match('(.*/)') or './'
local config = dofile(here .. '../../editors/neovim/lsp/vibc.lua')
config.cmd = { os.getenv('VIBC'), 'lsp' }
vim.opt.runtimepath:append(here .. '../../editors/neovim')
vim.cmd('runtime! ftdetect/vib.vim')
vim.lsp.config('vibc', config)
vim.lsp.enable('vibc')
vim.cmd.edit(model)
step('the file type is known', vim.bo.filetype == 'vib')

local function codes()
  local list = {}
  for _, finding in ipairs(vim.diagnostic.get(0)) do table.insert(list, finding.code) end
  table.sort(list)
  return table.concat(list, ' ')
end

local function see(expected)
  return vim.wait(10000, function() return codes() == expected end, 10)
end

step('two errors are seen', see('vib::field::unknown vib::unit::missing'))

-- A fix: the first action on the finding.
place('mas =')
local finding = vim.diagnostic.get(0, { lnum = vim.api.nvim_win_get_cursor(0)[1] - 1 })[1]
local client = vim.lsp.get_clients()[1]
local params = vim.lsp.util.make_range_params(0, client.offset_encoding)
params.context = { diagnostics = { finding.user_data.lsp } }
local answer = client:request_sync('textDocument/codeAction', params, 5000, 0)
vim.lsp.util.apply_workspace_edit(answer.result[1].edit, client.offset_encoding)
step('the fix is applied', text():find('mass = m', 1, true) and see('vib::unit::missing'))

place('10')
finding = vim.diagnostic.get(0)[1]
params = vim.lsp.util.make_range_params(0, client.offset_encoding)
params.range = finding.user_data.lsp.range
params.context = { diagnostics = { finding.user_data.lsp } }
answer = client:request_sync('textDocument/codeAction', params, 5000, 0)
vim.lsp.util.apply_workspace_edit(answer.result[1].edit, client.offset_encoding)
step('the unit is added', text():find('k = 10 N/m', 1, true) and see(''))

place('m  =')
vim.lsp.buf.rename('weight')
step('the parameter is renamed', vim.wait(5000, function()
  return text():find('param weight', 1, true) and text():find('mass = weight', 1, true)
end, 10))

vim.lsp.buf.format({ timeout_ms = 5000 })
step('the text is laid out', text():find('param weight = 2 kg\n', 1, true) and text():find('body block { mass = weight, moves x }', 1, true))

vim.lsp.inlay_hint.enable(true, { bufnr = 0 })
local function hints()
  local list = {}
  for _, hint in ipairs(vim.lsp.inlay_hint.get({ bufnr = 0 })) do table.insert(list, hint.inlay_hint.label) end
  return table.concat(list, ' ')
end
-- sqrt(10 / 2) rad/s
step('the frequencies are seen', vim.wait(5000, function() return hints():find('1 degree of freedom: 0.3559 Hz', 1, true) end, 10))

place('block {')
local page = client:request_sync('textDocument/hover', vim.lsp.util.make_position_params(0, client.offset_encoding), 5000, 0)
step('the pointer shows the body', page.result.contents.value:find('mass 2 kg', 1, true))

-- A model and the file of components that it uses, which is open beside it.
local folder = vim.fs.dirname(model)
vim.cmd.edit(folder .. '/axles.vib')
local library = vim.api.nvim_get_current_buf()
vim.cmd.edit(folder .. '/car.vib')
local function of_library()
  return table.concat(vim.api.nvim_buf_get_lines(library, 0, -1, false), '\n')
end
local function at(mark, offset)
  place(mark)
  local cursor = vim.api.nvim_win_get_cursor(0)
  vim.api.nvim_win_set_cursor(0, { cursor[1], cursor[2] + offset })
  return vim.lsp.util.make_position_params(0, client.offset_encoding)
end
step('a model of two files has no findings', see(''))

local found = client:request_sync('textDocument/definition', at('front.wheel', 6), 5000, 0).result[1]
step('a definition is in the other file', vim.endswith(found.uri, '/axles.vib') and found.range.start.line == 3)

local items = client:request_sync('textDocument/completion', at('front.lift', 6), 5000, 0).result
items = items.items or items
local labels = {}
for _, item in ipairs(items) do labels[item.label] = true end
step('parts of a component are proposed', labels.wheel and labels.lift and not labels.front)

page = client:request_sync('textDocument/hover', at('place front', 6), 5000, 0)
step('the pointer shows the component', page.result.contents.value:find('An axle on its tyre', 1, true))

at('front.wheel', 6)
vim.lsp.buf.rename('rim')
step('a name is changed in both files', vim.wait(5000, function()
  return text():find('front.rim', 1, true) and of_library():find('body   rim', 1, true)
end, 10))
step('both are without findings', see('') and #vim.diagnostic.get(library) == 0)

client:stop()
step('the server ends', vim.wait(5000, function() return client:is_stopped() end, 10))
vim.cmd('qall!')
