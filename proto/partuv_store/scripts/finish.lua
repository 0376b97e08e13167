-- ARGV: job id, attempt, the ending as JSON {status, code, fields, build, metrics}.
-- build: what made the result, '' where another run might give another result (nothing to cache).
-- Returns finished, or stale where another attempt or a cancel came first; then nothing is kept.
local id, attempt = ARGV[1], ARGV[2]
local job = key('job', id)
if not owns(id, attempt) then
  local current, status = unpack(redis.call('HMGET', job, 'attempt', 'status'))
  drop_parts(id, attempt)
  local mine = current == attempt and status ~= 'queued' and status ~= false
  return mine and 'finished' or 'stale' -- finished: the command was retried
end
local ending = cjson.decode(ARGV[3])
if ending.status == 'succeeded' and redis.call('HGET', job, 'cancel_requested') then
  ending.status = 'canceled'
end
if ending.status == 'succeeded' then
  local result = ending.build ~= '' and result_name(redis.call('HGET', job, 'cache_key'), ending.build) or id
  local fields = {}
  for name, value in pairs(ending.fields) do
    fields[#fields + 1] = name
    fields[#fields + 1] = value
  end
  if redis.call('EXISTS', key('result', result)) == 1 then
    fields = redis.call('HGETALL', key('result', result)) -- a twin was faster: same bytes
  else
    for _, kind in ipairs(KINDS) do
      move_blob(part_name(id, attempt, kind), 'result:' .. result .. ':' .. kind)
    end
    redis.call('HSET', key('result', result), unpack(fields))
  end
  local retention = tonumber(redis.call('HGET', job, 'retention_ms'))
  conclude(id, 'succeeded', '', {'result', result, 'progress', '1', unpack(fields)})
  hold_result(result, id, now() + retention)
else
  local fields = {}
  if ending.status == 'failed' then fields = {'error', ending.fields.error} end
  conclude(id, ending.status, ending.status == 'failed' and ending.code or '', fields)
end
drop_parts(id, attempt)
for field, amount in pairs(ending.metrics) do count(field, amount) end
return 'finished'
