// GPL-2.0-or-later. From script text to shaders, before any image is read.
#include "q3map2/shader/shader_parse.h"

#include "common/text/text.h"
#include "q3map2/shader/shader_directive.h"

#include <algorithm>
#include <utility>
#include <vector>

namespace q3 {

// ---- The text of shaders, tidied ----

bool ShaderTextScanner::NextArgument(std::string_view &token) {
    if (!scanner_.NextOnLine(token))
        return false;
    if (token == "{" || token == "}") {
        scanner_.PushBack();
        return false;
    }
    RecordToken(token);
    return true;
}

void ShaderTextScanner::SkipArguments() {
    for (std::string_view rest; NextArgument(rest);) {
    }
}

bool ShaderTextScanner::BlockFollows() const {
    constexpr std::size_t kReach = 1024; // bytes of comments between the name and the brace
    TextScanner ahead{std::string(scanner_.Unread().substr(0, kReach)), {}};
    std::string_view token;
    return ahead.Next(token) && token == "{";
}

void ShaderTextScanner::Forget() {
    if (!recording_)
        return;
    at_ = beforeLast_;
    text_.resize(at_.size);
}

void ShaderTextScanner::Record() {
    text_.clear();
    recording_ = true;
    at_ = {};
    Write("{");
}

std::string ShaderTextScanner::TakeText() {
    while (at_.depth > 0)
        Write("}");
    recording_ = false;
    return std::move(text_);
}

void ShaderTextScanner::StartLine() {
    if (at_.line != 0)
        text_ += '\n';
    text_.append(std::size_t(at_.depth), '\t');
}

void ShaderTextScanner::Write(std::string_view token) {
    const bool opens = token == "{", closes = token == "}";
    beforeLast_ = {text_.size(), at_.depth, at_.line};
    if (closes && at_.depth == 0)
        return;
    if (opens || closes) {
        at_.depth -= closes ? 1 : 0;
        StartLine();
        text_ += token;
        at_.depth += opens ? 1 : 0;
        text_ += '\n';
        at_.line = 0;
        return;
    }
    const bool quoted = token.empty() || std::any_of(token.begin(), token.end(),
                                                     [](char c) { return static_cast<unsigned char>(c) <= ' '; });
    if (at_.line == scanner_.Line())
        text_ += ' ';
    else
        StartLine();
    if (quoted)
        text_ += '"';
    text_ += token;
    if (quoted)
        text_ += '"';
    at_.line = scanner_.Line();
}

std::string TidyBody(std::string_view body) {
    TextScanner scanner{std::string(body), {}};
    ShaderTextScanner text(scanner);
    text.Record();
    for (std::string_view token; text.Next(token);) {
    }
    return text.TakeText();
}

// ---- Shaders of a script ----

namespace {

constexpr std::size_t kMaxName = 63;                 ///< bytes of a name in a .bsp, without the NUL
constexpr std::string_view kHiddenSuffix = ":q3map"; ///< hides a definition from the engine

class ScriptParser {
  public:
    ScriptParser(TextScanner &scanner, ShaderTable &table, Log &log)
        : scanner_(scanner), hasIncludes_(scanner.HasIncludes()), table_(table), log_(log) {}

    void ParseScript() {
        for (std::string_view token; scanner_.Next(token);) {
            const std::string name(token);
            std::string_view brace;
            if (!scanner_.Next(brace)) {
                WarnSyntax(name, "the end of the file");
                return;
            }
            if (brace == "{") {
                ParseShaders(name);
            } else {
                WarnSyntax(name, brace);
                scanner_.PushBack(); // perhaps the name of the next shader
            }
        }
    }

  private:
    using Words = std::vector<std::string_view>;
    void WarnSyntax(std::string_view name, std::string_view found) {
        log_.Warn("shader syntax", "{}: expected {{ after the shader name {}, found {}",
                  scanner_.TokenLocation().Text(), name, found);
    }
    /// Name of a shader that begins before the one that is read is closed; empty: none.
    using NextShader = std::string;
    void ParseShaders(std::string_view name);
    NextShader ParseShader(std::string_view name);
    NextShader ParseBody(bool &hasStages);
    NextShader ParseStage();
    void WarnMissingBrace(const TextLocation &begin, std::string_view what, std::string_view next);
    NextShader EndAtNextShader(const TextLocation &begin, std::string_view what, std::string_view found);
    bool IsNextShader(std::string_view word) const;
    void FindStageImage(std::string_view name, std::string &image);
    void ParseDirective(std::string_view word);
    void RunDirective(const ShaderDirective &directive, std::string_view word);
    bool HasNoImageYet() const {
        return shader_->editorImage.empty() && shader_->lightImage.empty() && shader_->implicitImage.empty();
    }

    ShaderTextScanner scanner_;
    bool hasIncludes_;
    ShaderTable &table_;
    Log &log_;
    std::unique_ptr<ParsedShader> shader_;
    Words words_;                   ///< arguments of the current directive
    bool lacksArguments_ = false;   ///< the directive before lacks arguments, which may stand on the next line
    const char *bodyEnd_ = nullptr; ///< where the next shader begins within this one; null: it does not
};

/// A shader and, as long as each lacks its closing brace, those that follow it.
void ScriptParser::ParseShaders(std::string_view name) {
    for (NextShader next = ParseShader(name); !next.empty();) {
        std::string_view brace;
        scanner_.Next(brace); // IsNextShader has seen it
        next = ParseShader(std::exchange(next, {}));
    }
}

/// Returns the name of the shader that begins within this one.
ScriptParser::NextShader ScriptParser::ParseShader(std::string_view name) {
    const bool isHidden = name.ends_with(kHiddenSuffix);
    if (isHidden)
        name.remove_suffix(kHiddenSuffix.size());
    if (name.size() > kMaxName)
        log_.Warn("long shader name", "{}: shader name {} is longer than the {} bytes that a map can hold",
                  scanner_.TokenLocation().Text(), name, kMaxName);
    shader_.reset(new ParsedShader(table_.MakeDefault(name))); // constructs the default on the heap, without a copy
    shader_->info.defined = true;
    bool hasStages = false;
    const char *bodyBegin = scanner_.Unread().data();
    if (hasIncludes_)
        scanner_.Record();
    bodyEnd_ = nullptr;
    NextShader next = ParseBody(hasStages);
    const LightmapDirectives &lightmap = shader_->info.lightmap;
    if (!lightmap.normalImage.empty() && !lightmap.ssbumpImage.empty())
        log_.Warn("two normal maps",
                  "{}: shader {}: has q3map_normalImage and q3map_ssbumpImage; the latter is not used",
                  scanner_.TokenLocation().Text(), name);
    WarnOfLateLines(*shader_, log_);
    shader_->info.scriptText.clear(), shader_->body.reset();
    // A hidden definition without stages only holds directives for the compiler. The engine draws another definition
    // of the same name, so this text is not kept.
    if (isHidden && !hasStages)
        scanner_.TakeText();
    else if (hasIncludes_)
        shader_->info.scriptText = scanner_.TakeText();
    else
        shader_->body.emplace(bodyBegin, bodyEnd_ ? bodyEnd_ : scanner_.Unread().data());
    table_.Define(std::move(shader_));
    return next;
}

/// Reads up to the closing brace.
ScriptParser::NextShader ScriptParser::ParseBody(bool &hasStages) {
    const TextLocation begin = scanner_.TokenLocation();
    lacksArguments_ = false;
    for (std::string_view word; scanner_.Next(word);) {
        if (word == "}")
            return {};
        if (!lacksArguments_ && IsNextShader(word))
            return EndAtNextShader(begin, "the shader", word);
        if (word == "{") {
            lacksArguments_ = false;
            hasStages = true;
            if (NextShader next = ParseStage(); !next.empty())
                return next;
        } else {
            ParseDirective(word);
        }
    }
    WarnMissingBrace(begin, "the shader", "the end of the file");
    return {};
}

void ScriptParser::WarnMissingBrace(const TextLocation &begin, std::string_view what, std::string_view next) {
    log_.Warn("missing brace in a script",
              "{}: shader {}: a '}}' is missing: {} that begins in line {} is not closed before {}",
              scanner_.TokenLocation().Text(), shader_->info.name, what, begin.line, next);
}

/// Warns that what began at `begin` is not closed before the shader named `found`, the last token. Returns that name.
ScriptParser::NextShader ScriptParser::EndAtNextShader(const TextLocation &begin, std::string_view what,
                                                       std::string_view found) {
    WarnMissingBrace(begin, what, fmt::format("shader {}", found));
    scanner_.Forget();
    if (!hasIncludes_)
        bodyEnd_ = found.data() - (found.data()[-1] == '"' ? 1 : 0);
    return NextShader(found);
}

/// Whether the word is the name of a shader whose brace follows, so that the shader before it lacks its own.
bool ScriptParser::IsNextShader(std::string_view word) const {
    const std::size_t slash = word.find_first_of("/\\", 1);
    return slash != std::string_view::npos && slash + 1 < word.size() && WithoutExtension(word) == word &&
           scanner_.BlockFollows();
}

void ScriptParser::FindStageImage(std::string_view name, std::string &image) {
    const bool builtIn = !name.empty() && (name[0] == '$' || name[0] == '*');
    shader_->builtInImage |= builtIn;
    if (image.empty() && !name.empty() && !builtIn)
        image = WithoutExtension(name);
}

/// Reads only names of images. Blocks do not nest, and line ends matter only where a brace is missing.
ScriptParser::NextShader ScriptParser::ParseStage() {
    const TextLocation begin = scanner_.TokenLocation();
    std::string_view word;
    std::string image; // the first of the stage
    NextShader next;
    bool afterStage = false, isNormalMap = false;
    int line = begin.line;
    while (scanner_.Next(word) && word != "}") {
        const bool isFirstOfLine = scanner_.TokenLocation().line != line;
        line = scanner_.TokenLocation().line;
        if (word == "{")
            WarnMissingBrace(begin, "the stage", "the next '{'");
        if (isFirstOfLine && IsNextShader(word)) {
            next = EndAtNextShader(begin, "the stage", word);
            break;
        }
        const StageWord use = FindStageWord(word);
        shader_->info.normalMapStage |= use == StageWord::NormalMap;
        isNormalMap |= use == StageWord::NormalMap && afterStage;
        afterStage = EqualNoCase(word, "stage");
        if (use != StageWord::Image && use != StageWord::Frames)
            continue;
        const int arguments = use == StageWord::Frames ? 2 : 1; // a rate, then the first frame
        bool more = true;
        for (int i = 0; i < arguments && more && word != "}"; ++i)
            more = scanner_.Next(word);
        line = scanner_.TokenLocation().line;
        if (!more || word == "}")
            break;
        FindStageImage(word, image);
    }
    if (HasNoImageYet() && !isNormalMap) // the image of `stage normalMap` has no color
        shader_->lightImage = image;
    return next;
}

void ScriptParser::ParseDirective(std::string_view word) {
    const bool mayBeArgument = std::exchange(lacksArguments_, false);
    if (const ShaderDirective *directive = FindDirective(word))
        return RunDirective(*directive, word);
    constexpr std::string_view kPrefix = "q3map_";
    const bool isOurs = StartsWithNoCase(word, kPrefix);
    const DirectiveContext context{*shader_, table_, scanner_.TokenLocation(), log_};
    const bool isKnown =
        isOurs ? context.ApplyParm(word.substr(kPrefix.size())) : mayBeArgument || IsEngineDirective(LowerCase(word));
    if (!isKnown)
        log_.Warn("unknown shader directive", "{}: shader {}: unknown directive {}{}", context.location.Text(),
                  shader_->info.name, word,
                  scanner_.BlockFollows() ? "; if it is the name of a shader, a '}' is missing before it"
                                          : NearestDirective(word, table_.GameRules()));
    scanner_.SkipArguments();
}

void ScriptParser::RunDirective(const ShaderDirective &directive, std::string_view word) {
    const TextLocation location = scanner_.TokenLocation();
    const std::size_t required = directive.info.MinValues(), most = directive.info.MaxValues();
    words_.clear();
    for (std::string_view next; directive.apply && words_.size() < most && scanner_.NextArgument(next);)
        if (next != "(" && next != ")")
            words_.emplace_back(next);
    DirectiveContext context{*shader_, table_, location, log_};
    if (directive.apply && words_.size() < required) {
        lacksArguments_ = true;
        log_.Warn("incomplete shader directive", "{}: shader {}: {} with {} arguments, expected {}", location.Text(),
                  shader_->info.name, word, words_.size(), required);
    } else if (const std::string fault = directive.apply ? directive.apply(context, words_) : std::string();
               !fault.empty()) {
        log_.Warn("shader directive", "{}: shader {}: {}: {}", location.Text(), shader_->info.name, word, fault);
    }
    if (!StartsWithNoCase(word, "qer_")) // editors read those of any line
        ++shader_->linesRead;
    if (directive.rest == RestOfLine::Ignored)
        scanner_.SkipArguments();
}

} // namespace

void ParseShaderScript(TextScanner &scanner, ShaderTable &table, Log &log) {
    ScriptParser(scanner, table, log).ParseScript();
}

} // namespace q3
