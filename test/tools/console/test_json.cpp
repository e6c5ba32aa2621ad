// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// JSON as the tools write it, and what of a damaged file is refused.
#include "console/json.hpp"
#include <catch2/catch.hpp>
#include <cmath>
#include <limits>
#include <sstream>

using namespace tools;

namespace {

Json readFrom(const std::string& text)
{
    std::istringstream in(text);
    return Json::read(in);
}

} // namespace

TEST_CASE("JSON is written in the order in which it came", "[json]")
{
    Json json = {{"text", "a \"b\"\n"}, {"whole", 3}, {"third", 1./3.}, {"none", nullptr}, {"flag", true}, {"inner", {{"x", 0.1}}},
                 {"list", std::vector<int>{1, 2}}};
    json.set("whole", (size_t)4);
    json.set("nan", NAN);
    json.set("infinity", std::numeric_limits<double>::infinity());
    json.set("latin", "\xe4");
    CHECK(json.text(-1) == "{\"text\":\"a \\\"b\\\"\\n\",\"whole\":4,\"third\":0.3333333333333333,\"none\":null,\"flag\":true,"
                           "\"inner\":{\"x\":0.1},\"list\":[1,2],\"nan\":null,\"infinity\":null,\"latin\":\"\xef\xbf\xbd\"}");
    json.roundTo(3);
    CHECK(json.at("third").asNumber() == 0.333);
    CHECK(json.at("inner").at("x").asNumber() == 0.1);
    Json list = Json::array({1., Json::object()});
    list.append({{"a", Json::array()}});
    CHECK(list.text(1) == "[\n 1.0,\n {},\n {\n  \"a\": []\n }\n]");
}

TEST_CASE("JSON comes back as it was written", "[json]")
{
    const std::string text = "{\"b\":[0.1,2,-3e-300],\"a\":{\"c\":[\"x\",\"y\"],\"d\":null,\"e\":false},\"f\":[[1,2],[3]]}";
    const Json json = readFrom(text);
    CHECK(json.text(-1) == text);
    CHECK(json.at("b").asNumbers() == std::vector<double>{0.1, 2., -3e-300});
    CHECK(json.at("a").at("c").asTexts() == std::vector<std::string>{"x", "y"});
    CHECK(json.at("f").at(0).asWholes() == std::vector<int>{1, 2});
    CHECK(json.at("f").items().size() == 2);
}

TEST_CASE("What a JSON file lacks is said", "[json]")
{
    for (const std::string& wrong : {std::string(), std::string("{\"a\": [1, 2"), std::string("{} x"),
                                     std::string(5000, '[') + std::string(5000, ']')})
        CHECK_THROWS_AS(readFrom(wrong), Json::Error);
    const Json json = readFrom("{\"text\": \"x\", \"list\": [1, 0.5]}");
    CHECK_THROWS_AS(json.at("other"), Json::Error);
    CHECK_THROWS_AS(json.at("text").at("x"), Json::Error);
    CHECK_THROWS_AS(json.at("text").asNumber(), Json::Error);
    CHECK_THROWS_AS(json.at("text").items(), Json::Error);
    CHECK_THROWS_AS(json.at("list").asText(), Json::Error);
    CHECK_THROWS_AS(json.at("list").asWholes(), Json::Error);
    CHECK_THROWS_AS(json.at("list").at(2), Json::Error);
}
