// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "match/chains.hpp"

#include <map>

namespace tools {

namespace {

//! Sets of nodes that are joined two by two.
class Sets
{
public:
    explicit Sets(int count) : parent_(count)
    {
        for (int i = 0; i < count; i++)
            parent_[i] = i;
    }
    int find(int node)
    {
        while (parent_[node] != node)
            node = parent_[node] = parent_[parent_[node]];
        return node;
    }
    void join(int a, int b) { parent_[find(a)] = find(b); }

private:
    std::vector<int> parent_;
};

//! Of each feature the first at its place.
std::vector<int> firstAtPlace(const Features& features)
{
    std::map<std::pair<double, double>, int> places;
    std::vector<int> first;
    for (int i = 0; i < features.size(); i++)
        first.push_back(places.insert({{features.pixels[i].x, features.pixels[i].y}, i}).first->second);
    return first;
}

} // namespace

std::vector<Chain> chainsOf(const std::vector<Features>& features, const std::vector<PairMatches>& matches)
{
    const int cameras = (int)features.size();
    std::vector<int> begin = {0};
    std::vector<std::vector<int>> first;
    for (const Features& ofCamera : features)
    {
        begin.push_back(begin.back() + ofCamera.size());
        first.push_back(firstAtPlace(ofCamera));
    }
    Sets sets(begin.back());
    for (const PairMatches& m : matches)
        for (const auto& pair : m.pairs)
            sets.join(begin[m.first] + first[m.first][pair.first], begin[m.second] + first[m.second][pair.second]);
    const int CONTRADICTION = -2;
    std::map<int, Chain> chains;
    for (int c = 0; c < cameras; c++)
        for (int i = 0; i < features[c].size(); i++)
        {
            if (first[c][i] != i)
                continue;
            int& at = chains.insert({sets.find(begin[c] + i), Chain(cameras, -1)}).first->second[c];
            at = at == -1 ? i : CONTRADICTION;
        }
    std::vector<Chain> result;
    for (const auto& chain : chains)
    {
        int seen = 0;
        bool contradicts = false;
        for (int i : chain.second)
        {
            seen += i >= 0;
            contradicts |= i == CONTRADICTION;
        }
        if (seen > 1 && !contradicts)
            result.push_back(chain.second);
    }
    return result;
}

} // namespace tools
