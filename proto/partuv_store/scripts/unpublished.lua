-- ARGV: age in ms. Returns waiting jobs {never published or given back, published longer ago}.
local never, old = {}, {}
local oldest = now() - tonumber(ARGV[1])
for _, id in ipairs(redis.call('ZRANGE', key('waiting'), 0, -1)) do
  local published_at = tonumber(redis.call('HGET', key('job', id), 'published_at') or '-1')
  if published_at == 0 then
    never[#never + 1] = id
  elseif published_at > 0 and published_at < oldest then
    old[#old + 1] = id
  elseif published_at < 0 then
    redis.call('ZREM', key('waiting'), id)
  end
end
return {never, old}
