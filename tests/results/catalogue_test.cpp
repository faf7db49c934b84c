// catalogue.json of a result folder: read, written, joined, damaged, absent.
#include "results/catalogue.hpp"

#include <gmock/gmock.h>

#include <string>

#include "results/merge.hpp"
#include "results/store.hpp"
#include "tests/support/temporary_folder.hpp"

namespace polhode::results {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;

constexpr auto text = R"([
 {"name": "gauss2", "family": "gauss", "order": 4, "adaptive_only": false, "rival": false,
  "preserves": ["norm", "energy"], "needs": "none", "source": "HLW", "pitfall": "not symplectic"},
 {"name": "ida", "family": "library", "order": null, "adaptive_only": true}
])";

class CatalogueFile : public testing::Test {
 protected:
  fs::path folder(std::string const& name, std::string const& content) const {
    fs::create_directories(root / name);
    write_catalogue(root / name, content);
    return root / name;
  }

  test::TemporaryFolder top;
  fs::path const root = top.path;
};

TEST_F(CatalogueFile, IsReadWithTheRecords) {
  Contents const contents = read(folder("a", text));
  ASSERT_EQ(contents.catalogue.size(), 2u);
  IntegratorFacts const& gauss = contents.catalogue.at("gauss2");
  EXPECT_EQ(gauss.family, "gauss");
  EXPECT_EQ(gauss.order, 4);
  EXPECT_FALSE(gauss.adaptive_only);
  EXPECT_THAT(gauss.preserves, ElementsAre("norm", "energy"));
  EXPECT_EQ(gauss.source, "HLW");
  EXPECT_EQ(gauss.pitfall, "not symplectic");
  EXPECT_FALSE(contents.catalogue.at("ida").order);
  EXPECT_TRUE(contents.catalogue.at("ida").adaptive_only);
  EXPECT_EQ(std::distance(fs::directory_iterator(root / "a"), {}), 1) << "no draft stays";
}

TEST_F(CatalogueFile, AFolderWithoutOneSaysNothing) {
  EXPECT_TRUE(read(root).catalogue.empty());
}

TEST_F(CatalogueFile, DamageNamesTheFile) {
  for (auto const* damaged :
       {"[{\"name\": \"rk4\"", "{}", "[{\"family\": \"gauss\"}]", "[{\"name\": \"rk4\", \"order\": \"four\"}]",
        "[{\"name\": \"rk4\", \"preserves\": 3}]"}) {
    fs::path const broken = folder("broken", damaged);
    try {
      read(broken);
      ADD_FAILURE() << damaged;
    } catch (StoreError const& error) {
      EXPECT_THAT(error.what(), HasSubstr((broken / "catalogue.json").string())) << damaged;
    }
  }
}

TEST_F(CatalogueFile, MergingJoinsThem) {
  fs::path const a = folder("a", text);
  fs::path const b = folder("b", R"([{"name": "ida", "family": "library", "pitfall": "newer"}, {"name": "rk4"}])");
  fs::create_directories(root / "none");
  merge(root / "out", {a, root / "none", b});
  Catalogue const joined = read(root / "out").catalogue;
  EXPECT_EQ(joined.size(), 3u);
  EXPECT_EQ(joined.at("gauss2").order, 4);
  EXPECT_EQ(joined.at("ida").pitfall, "newer") << "the last is right";
  EXPECT_FALSE(joined.at("ida").adaptive_only);
  EXPECT_TRUE(joined.contains("rk4"));
  merge(root / "empty", {root / "none"});
  EXPECT_FALSE(fs::exists(root / "empty" / "catalogue.json"));
}

TEST_F(CatalogueFile, NothingIsMergedFromDamage) {
  fs::path const broken = folder("broken", "[");
  EXPECT_THROW(merge(root / "out", {broken}), StoreError);
  EXPECT_FALSE(fs::exists(root / "out"));
}

}  // namespace
}  // namespace polhode::results
