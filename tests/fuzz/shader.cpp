// GPL-2.0-or-later. Fuzz target shader: shader scripts as the compiler and as engines read them.
#include "common/text/text_scan.h"
#include "q3map2/pk3/engine_scripts.h"
#include "q3map2/shader/games.h"
#include "q3map2/shader/shader_parse.h"
#include "q3map2/shader/shader_table.h"
#include "tests/fuzz/fuzz_target.h"

namespace q3::fuzz {
namespace {

/// Names of all shaders of the table.
std::vector<std::string> NamesIn(ShaderTable &table) {
    std::vector<std::string> names;
    table.ForEach([&names](ParsedShader &shader) { names.push_back(shader.info.name); });
    return names;
}

void ReadAsCompiler(std::string_view text, const Game &game) {
    SilentLog log;
    ShaderTable table(game, ShaderOptions{});
    TextScanner scanner(std::string(text), "x.shader");
    Accepts([&] { ParseShaderScript(scanner, table, log); });
    for (const std::string &name : NamesIn(table))
        table.FindOrAdd(name, log);
}

/// Tidied text is tidy.
void Tidy(std::string_view text) {
    std::string once;
    if (Accepts([&] { once = TidyBody(text); }))
        Accepts([&] { TidyBody(once); });
}

void ReadAsEngine(std::string_view text) {
    SilentLog log;
    EngineScripts scripts;
    Accepts([&] { scripts.Read("scripts/x.shader", std::string(text), log); });
    for (const EngineScripts::Script &script : scripts.Scripts())
        for (const std::string &shader : script.shaders)
            for (const EngineShader &found : scripts.Find(shader))
                Accepts([&] { StrippedText(found); });
}

/// All tokens, in the dialect.
void Scan(std::string_view text, TextDialect dialect) {
    const auto include = [](std::string_view name) {
        return name == "a" ? std::optional<std::string>("x $include b\n") : std::nullopt;
    };
    TextScanner scanner(std::string(text), "x.txt", include, dialect);
    Accepts([&] {
        for (std::string token; scanner.Next(token);)
            Require(scanner.Line() >= 1, "a token before the first line");
    });
}

} // namespace
} // namespace q3::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t *data, std::size_t size) {
    using namespace q3::fuzz;
    const std::string_view text = Input(data, size).Text();
    for (const std::string_view game : {"quake3", "ja"})
        ReadAsCompiler(text, *q3::FindGame(game));
    Tidy(text);
    ReadAsEngine(text);
    for (const auto dialect : {q3::TextDialect::Compiler, q3::TextDialect::Engine, q3::TextDialect::MapSource})
        Scan(text, dialect);
    return 0;
}
