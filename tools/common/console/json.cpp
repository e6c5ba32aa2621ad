// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "console/json.hpp"
#include "console/numbers.hpp"

#include <nlohmann/json.hpp>
#include <algorithm>
#include <cmath>

using Tree = nlohmann::ordered_json;

namespace tools {

//! To nlohmann's trees and back.
class JsonConverter
{
public:
    static Tree treeOf(const Json& json)
    {
        switch (json.kind_)
        {
        case Json::FLAG: return json.flag_;
        case Json::WHOLE: return json.whole_;
        case Json::NUMBER: return json.number_;
        case Json::TEXT: return json.text_;
        case Json::LIST: return listOf(json);
        case Json::OBJECT: return objectOf(json);
        default: return nullptr;
        }
    }

    //! @param depth how many lists and objects it is in
    static Json jsonOf(const Tree& tree, int depth = 0)
    {
        const int DEEPEST = 100;        // what calls itself for each level must not be led on by a file
        if (depth > DEEPEST)
            throw Json::Error("too many levels");
        switch (tree.type())
        {
        case Tree::value_t::null: return nullptr;
        case Tree::value_t::boolean: return tree.get<bool>();
        case Tree::value_t::string: return tree.get_ref<const std::string&>();
        case Tree::value_t::number_float: return tree.get<double>();
        case Tree::value_t::array:
        case Tree::value_t::object: break;
        default:                        // a whole number
            Json whole(Json::WHOLE);
            whole.whole_ = tree.get<int64_t>();
            return whole;
        }
        Json json(tree.is_array() ? Json::LIST : Json::OBJECT);
        for (const auto& item : tree.items())
        {
            if (tree.is_object())
                json.names_.push_back(item.key());
            json.items_.push_back(jsonOf(item.value(), depth + 1));
        }
        return json;
    }

private:
    static Tree listOf(const Json& json)
    {
        Tree tree = Tree::array();
        for (const Json& item : json.items_)
            tree.push_back(treeOf(item));
        return tree;
    }

    static Tree objectOf(const Json& json)
    {
        Tree tree = Tree::object();
        for (size_t i = 0; i < json.items_.size(); i++)
            tree.emplace(json.names_[i], treeOf(json.items_[i]));
        return tree;
    }
};

Json::Json(std::nullptr_t) {}

Json::Json(bool flag) : kind_(FLAG), flag_(flag) {}

Json::Json(int number) : kind_(WHOLE), whole_(number) {}

Json::Json(size_t number) : kind_(WHOLE), whole_((int64_t)number) {}

Json::Json(double number) : kind_(NUMBER), number_(number) {}

Json::Json(const char* text) : kind_(TEXT), text_(text) {}

Json::Json(const std::string& text) : kind_(TEXT), text_(text) {}

Json::Json(const Json& other) = default;
Json::Json(Json&& other) noexcept = default;
Json& Json::operator=(const Json& other) = default;
Json& Json::operator=(Json&& other) noexcept = default;
Json::~Json() = default;

Json::Json(const std::vector<double>& numbers) : kind_(LIST), items_(numbers.begin(), numbers.end()) {}

Json::Json(const std::vector<int>& numbers) : kind_(LIST), items_(numbers.begin(), numbers.end()) {}

Json::Json(const std::vector<std::string>& texts) : kind_(LIST), items_(texts.begin(), texts.end()) {}

Json::Json(const std::vector<Json>& items) : kind_(LIST), items_(items) {}

Json::Json(std::initializer_list<JsonMember> members) : kind_(OBJECT)
{
    for (const JsonMember& member : members)
        set(member.name, member.value);
}

Json Json::array(std::initializer_list<Json> items)
{
    Json json(LIST);
    json.items_ = items;
    return json;
}

Json Json::object() { return Json(OBJECT); }

void Json::append(const Json& item)
{
    CV_Assert(kind_ == LIST);
    items_.push_back(item);
}

void Json::set(const std::string& name, const Json& value)
{
    CV_Assert(kind_ == OBJECT);
    const size_t i = std::find(names_.begin(), names_.end(), name) - names_.begin();
    if (i < items_.size())
        items_[i] = value;
    else
    {
        names_.push_back(name);
        items_.push_back(value);
    }
}

void Json::roundTo(int digits)
{
    if (kind_ == NUMBER && std::isfinite(number_))
        parseNumber(cv::format("%.*g", digits, number_), number_);
    for (Json& item : items_)
        item.roundTo(digits);
}

std::string Json::text(int indent) const
{
    return JsonConverter::treeOf(*this).dump(indent, ' ', false, Tree::error_handler_t::replace);
}

Json Json::read(std::istream& in)
{
    try
    {
        const bool throws = true, skipsComments = true;         // as cv::FileStorage
        return JsonConverter::jsonOf(Tree::parse(in, nullptr, throws, skipsComments));
    }
    catch (const Tree::exception& e)
    {
        const std::string what = e.what();          // "[json.exception.parse_error.101] parse error at line 1, ..."
        throw Error(what.substr(what.find("] ") == std::string::npos ? 0 : what.find("] ") + 2));
    }
}

const Json& Json::at(const std::string& name) const
{
    const size_t i = std::find(names_.begin(), names_.end(), name) - names_.begin();
    if (i >= names_.size())
        throw Error("there is no '" + name + "'");
    return items_[i];
}

bool Json::has(const std::string& name) const { return std::find(names_.begin(), names_.end(), name) != names_.end(); }

const Json& Json::at(size_t index) const
{
    if (kind_ != LIST || index >= items_.size())
        throw Error("a list is too short");
    return items_[index];
}

const std::vector<Json>& Json::items() const
{
    if (kind_ != LIST)
        throw Error("a list is missing");
    return items_;
}

const std::string& Json::asText() const
{
    if (kind_ != TEXT)
        throw Error("a text is missing");
    return text_;
}

bool Json::asFlag() const
{
    if (kind_ != FLAG)
        throw Error("true or false is missing");
    return flag_;
}

double Json::asNumber() const
{
    if (kind_ != NUMBER && kind_ != WHOLE)
        throw Error("a number is missing");
    return kind_ == WHOLE ? (double)whole_ : number_;
}

std::vector<double> Json::asNumbers() const
{
    std::vector<double> numbers;
    for (const Json& item : items())
        numbers.push_back(item.asNumber());
    return numbers;
}

std::vector<int> Json::asWholes() const
{
    std::vector<int> numbers;
    for (const Json& item : items())
    {
        if (item.kind_ != WHOLE)
            throw Error("a whole number is missing");
        numbers.push_back((int)item.whole_);
    }
    return numbers;
}

std::vector<std::string> Json::asTexts() const
{
    std::vector<std::string> texts;
    for (const Json& item : items())
        texts.push_back(item.asText());
    return texts;
}

} // namespace tools
