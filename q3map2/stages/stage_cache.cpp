// GPL-2.0-or-later. -cache, -part and -join for stages.
#include "q3map2/stages/stage_cache.h"

#include "common/error.h"
#include "common/files/files.h"
#include "q3map2/report/run_report.h"
#include "q3map2/report/version.h"
#include "q3map2/stages/run_events.h"
#include "q3map2/units/unit_bytes.h"

#include <algorithm>
#include <cstdlib>
#include <deque>
#include <system_error>

namespace q3 {

namespace fs = std::filesystem;

std::optional<Cache> CacheOf(const StageContext &context) {
    const std::string &folder = context.options.cache;
    if (folder.empty())
        return std::nullopt;
    constexpr std::uint64_t kMegabyte = 1 << 20;
    return Cache(folder == "default" ? DefaultCacheFolder() : fs::absolute(folder),
                 std::uint64_t(context.options.cacheSize) * kMegabyte, context.log);
}

Hash128 HashOfPortableSettings(const StageContext &context, const std::vector<std::string> &words) {
    const GlobalOptions &options = context.options;
    KeyBuilder key("settings");
    key.AddText(kVersion);
    key.AddText(context.stage.word);
    key.AddText(options.game->name);
    key.Add(options.force, options.subdivisions, options.maxDrawSurfaces);
    for (const std::string &word : words)
        key.AddText(word);
    return key.Key();
}

Hash128 HashOfSettings(const StageContext &context, const std::vector<std::string> &words) {
    const Hash128 portable = HashOfPortableSettings(context, words),
                  program = HashOf(MappedFile(context.program).Bytes());
    KeyBuilder key("local settings");
    key.Add(portable.low, portable.high, program.low, program.high);
    key.AddText(VersionText()); // names the kind of processor
    const char *const embree = std::getenv("Q3MAP2_EMBREE");
    key.AddText(embree ? embree : "");
    return key.Key();
}

// ---- What an entry holds ----

namespace {

bool HasContents(const fs::path &path, std::span<const std::byte> contents) {
    return SizeOfFile(path) == contents.size() && std::ranges::equal(MappedFile(path).Bytes(), contents);
}

/// Results of an entry, by name.
constexpr std::string_view kRequests = "requests", kEvents = "events", kFaults = "faults";

Hash128 KeyOf(std::string_view name) {
    return HashOf(name);
}

Hash128 KeyOf(const fs::path &output) {
    return HashOf("file " + output.string());
}

/// Null: there is none.
const UnitResult *Find(const UnitFile &entry, const Hash128 &key) {
    const auto found = std::ranges::find(entry.results, key, &UnitResult::key);
    return found == entry.results.end() ? nullptr : &*found;
}

std::span<const std::byte> Named(const UnitFile &entry, const Hash128 &key) {
    const UnitResult *const found = Find(entry, key);
    return found ? found->bytes : std::span<const std::byte>();
}

std::vector<std::string> ReadTexts(std::span<const std::byte> bytes) {
    std::vector<std::string> texts;
    UnitReader(bytes).GetTexts(texts);
    return texts;
}

std::vector<std::byte> BytesOfTexts(const std::vector<std::string> &texts) {
    UnitWriter writer;
    writer.PutTexts(texts);
    return writer.Take();
}

Hash128 AnswersOf(const VirtualFileSystem *vfs, const std::vector<std::string> &requests) {
    return vfs ? vfs->AnswersTo(requests) : Hash128{};
}

} // namespace

// ---- Finding and keeping outputs ----

StageCache::StageCache(const StageContext &context, const std::vector<std::string> &words, const Files &files)
    : context_(context), files_(files) {
    if (files.guard.WritesIntoFolders() || context.options.cache.empty())
        return;
    cache_ = CacheOf(context);
    inputs_ = files.guard.InputFiles();
    outputs_ = files.guard.OutputFiles();
    inputs_.insert(inputs_.end(), files.moreInputs.begin(), files.moreInputs.end());
    outputs_.insert(outputs_.end(), files.moreOutputs.begin(), files.moreOutputs.end());
    settings_ = HashOfSettings(context, words);
    key_ = KeyOfInputs();
    events_ = std::make_unique<RunEvents>(context.log);
    if (files.vfs)
        files.vfs->RecordRequests();
}

StageCache::~StageCache() = default;

Hash128 StageCache::KeyOfInputs() const {
    KeyBuilder key("stage");
    key.Add(settings_.low, settings_.high);
    for (const fs::path &input : inputs_) {
        key.AddText(input.string());
        std::error_code failed;
        const bool exists = fs::is_regular_file(input, failed);
        const Hash128 hash = exists ? HashOf(MappedFile(input).Bytes()) : Hash128{};
        key.Add(exists, hash.low, hash.high);
    }
    for (const fs::path &output : outputs_)
        key.AddText(output.string());
    return key.Key();
}

bool StageCache::Restore() {
    if (!cache_)
        return false;
    const std::optional<UnitFile> entry = cache_->Read(key_);
    if (!entry || AnswersOf(files_.vfs, ReadTexts(Named(*entry, KeyOf(kRequests)))) != entry->header.inputs)
        return false;
    FileSet written;
    for (const fs::path &output : outputs_) {
        const UnitResult *const kept = Find(*entry, KeyOf(output));
        if (kept && !HasContents(output, kept->bytes))
            written.Add(output).Append(kept->bytes);
    }
    for (const fs::path &output : outputs_)
        if (!Find(*entry, KeyOf(output)))
            written.AddRemoval(output);
    written.Commit();
    events_.reset();
    RunEvents::Replay(Named(*entry, KeyOf(kEvents)), context_.log);
    for (const std::string &fault : ReadTexts(Named(*entry, KeyOf(kFaults))))
        context_.report.AddFault(fault);
    context_.log.Print("Nothing has changed since an earlier run: its results are taken from the cache\n");
    return true;
}

void StageCache::Store() {
    if (!cache_ || (files_.vfs && !files_.vfs->ReadFilesAreUnchanged()))
        return;
    try {
        StoreOutputs();
    } catch (const Error &error) {
        context_.log.Warn("cache", "-cache: the results of this run are not kept: {}", error.what());
    }
}

void StageCache::StoreOutputs() {
    UnitFile entry;
    std::deque<std::vector<std::byte>> storage;
    const auto add = [&](const Hash128 &key, std::vector<std::byte> bytes) {
        entry.results.push_back({key, storage.emplace_back(std::move(bytes))});
    };
    const std::vector<std::string> requests = files_.vfs ? files_.vfs->Requests() : std::vector<std::string>();
    entry.header.stage = context_.stage.word;
    entry.header.text = "outputs of a stage";
    entry.header.inputs = AnswersOf(files_.vfs, requests);
    add(KeyOf(kRequests), BytesOfTexts(requests));
    add(KeyOf(kEvents), events_->Take());
    const std::string faults = context_.report.Faults();
    add(KeyOf(kFaults), BytesOfTexts(faults.empty() ? std::vector<std::string>() : std::vector{faults}));
    std::deque<MappedFile> contents;
    for (const fs::path &output : outputs_)
        if (std::error_code failed; fs::is_regular_file(output, failed))
            entry.results.push_back({KeyOf(output), contents.emplace_back(output).Bytes()});
    cache_->Write(key_, entry);
}

// ---- Results of units ----

RunUnits::RunUnits(const StageContext &context, const std::vector<std::string> &words, const PartOptions &parts,
                   const fs::path &map)
    : context_(context) {
    const std::string_view stage = context.stage.word;
    units_ = MakePartStore(parts, stage, context.log);
    if (units_) {
        if (!context.options.cache.empty())
            throw Error("-cache: not together with -part or -join");
        units_->settings = HashOfPortableSettings(context, words);
        return;
    }
    cache_ = CacheOf(context);
    if (!cache_)
        return;
    units_ = std::make_unique<UnitStore>(UnitStore::Purpose::Cache);
    units_->settings = HashOfSettings(context, words);
    KeyBuilder key("units");
    key.Add(units_->settings.low, units_->settings.high);
    key.AddText(map.string());
    key_ = key.Key();
    if (std::optional<UnitFile> known = cache_->Read(key_))
        units_->Load(known->results, std::move(known->storage), known->header.inputs);
}

void RunUnits::Keep(const VirtualFileSystem &vfs) const {
    if (!cache_ || !units_ || !vfs.ReadFilesAreUnchanged())
        return;
    context_.log.Count(units_->FoundCount(), "units taken from the cache");
    context_.log.Count(units_->KeptCount(), "units computed");
    if (!units_->HasChanged())
        return;
    UnitFile file;
    file.header.stage = context_.stage.word;
    file.header.text = "units of light";
    file.header.inputs = units_->Inputs();
    file.results = units_->Used();
    cache_->Write(key_, file);
}

} // namespace q3
