// The unit of a number: directly after it or after one space, glued together (spec.md#units).

#include "tree_sitter/parser.h"

enum Token { UNIT, RECOVERY };

static bool letter(int32_t c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_' || (c >= 0x391 && c <= 0x3C9) ||
           (c >= 0x3D0 && c <= 0x3D6) || (c >= 0x3F0 && c <= 0x3F5) || c == 0xB5 || c == '%' || c == 0xB0;
}

static bool digit(int32_t c) { return c >= '0' && c <= '9'; }

static void advance(TSLexer *lexer) { lexer->advance(lexer, false); }

// The word of a unit, up to its end; false where it goes on with the declaration, as in `inertia = 0 about A`.
static bool word(TSLexer *lexer) {
    static const char *const others[] = {"about", "at", "turned", "mirrored", "over", "while", "within", "spread"};
    char text[9] = {0};
    unsigned length = 0;
    for (; letter(lexer->lookahead) || digit(lexer->lookahead); length++) {
        if (length < 8) text[length] = lexer->lookahead < 128 ? (char)lexer->lookahead : '?';
        advance(lexer);
    }
    for (unsigned i = 0; i < sizeof others / sizeof *others; i++) {
        unsigned same = 0;
        while (others[i][same] && others[i][same] == text[same]) same++;
        if (!others[i][same] && same == length) return false;
    }
    return true;
}

// `^2`, `^-2`, `²`, `³`, or nothing; false after a `^` without digits, which is an operator and ends the unit before it.
static bool power(TSLexer *lexer) {
    lexer->mark_end(lexer);
    if (lexer->lookahead == 0xB2 || lexer->lookahead == 0xB3) {
        advance(lexer);
        lexer->mark_end(lexer);
    } else if (lexer->lookahead == '^') {
        advance(lexer);
        if (lexer->lookahead == '-') advance(lexer);
        if (!digit(lexer->lookahead)) return false;
        while (digit(lexer->lookahead)) advance(lexer);
        lexer->mark_end(lexer);
    }
    return true;
}

static bool between(int32_t c) { return c == '*' || c == '/' || c == 0xB7 || c == 0x22C5; }

bool tree_sitter_vib_external_scanner_scan(void *payload, TSLexer *lexer, const bool *valid) {
    (void)payload;
    if (!valid[UNIT] || valid[RECOVERY]) return false;
    if (lexer->lookahead == ' ') {
        lexer->advance(lexer, true);
        if (lexer->lookahead == '/') advance(lexer);
    }
    if (!letter(lexer->lookahead) || !word(lexer)) return false;
    lexer->result_symbol = UNIT;
    while (power(lexer) && between(lexer->lookahead)) {
        advance(lexer);
        if (!letter(lexer->lookahead)) break;
        word(lexer);
    }
    return true;
}

// It remembers nothing.
void *tree_sitter_vib_external_scanner_create(void) { return NULL; }
void tree_sitter_vib_external_scanner_destroy(void *payload) { (void)payload; }
unsigned tree_sitter_vib_external_scanner_serialize(void *payload, char *buffer) {
    (void)payload;
    (void)buffer;
    return 0;
}
void tree_sitter_vib_external_scanner_deserialize(void *payload, const char *buffer, unsigned length) {
    (void)payload;
    (void)buffer;
    (void)length;
}
