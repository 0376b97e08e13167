-- ARGV: the submission as JSON. Returns {outcome, job id}; outcomes: created, cached, replayed,
-- idempotency_key_reused, queue_full, too_many_jobs, upload_lost. The upload is dropped unless it is queued.
local s = cjson.decode(ARGV[1])
local job = key('job', s.id)
if redis.call('EXISTS', job) == 1 then return {'created', s.id} end -- the command was retried

if s.idempotency ~= '' then
  local known = redis.call('GET', key('idempotency', s.idempotency))
  local fingerprint = known and redis.call('HGET', key('job', known), 'fingerprint')
  if fingerprint then
    drop_blob('upload:' .. s.id)
    if fingerprint == s.fingerprint then return {'replayed', known} end
    return {'idempotency_key_reused', known}
  end
end

local build = redis.call('GET', key('build'))
local name = build and result_name(s.cache_key, build) or ''
local result = build and redis.call('HGETALL', key('result', name)) or {}
if #result > 0 and redis.call('EXISTS', key('blob', 'result:' .. name .. ':glb')) == 0 then
  result = {}
end
if #result == 0 then
  local refusal = nil
  if redis.call('HLEN', key('blob', 'upload:' .. s.id)) ~= s.input_chunks then
    refusal = 'upload_lost'
  elseif s.queue_limit > 0 and redis.call('ZCARD', key('waiting')) >= s.queue_limit then
    refusal = 'queue_full'
  elseif s.owner_limit > 0 and redis.call('SCARD', key('active', s.owner)) >= s.owner_limit then
    refusal = 'too_many_jobs'
  end
  if refusal then
    drop_blob('upload:' .. s.id)
    return {refusal, ''}
  end
end

local time = now()
-- published_at: the message follows at once; if it doesn't, its age will show.
redis.call('HSET', job, 'id', s.id, 'owner', s.owner, 'status', 'queued', 'stage', '',
  'progress', '0', 'revision', '0', 'attempt', '0', 'losses', '0', 'published_at', text(time),
  'created_at', text(time), 'expires_at', text(time + s.retention_ms),
  'retention_ms', text(s.retention_ms), 'options', s.options,
  'input_sha256', s.input_sha256, 'input_bytes', text(s.input_bytes),
  'input_chunks', text(s.input_chunks),
  'fingerprint', s.fingerprint, 'idempotency', s.idempotency, 'cache_key', s.cache_key,
  'webhook_url', s.webhook_url, 'request_id', s.request_id)
if s.idempotency ~= '' then
  redis.call('SET', key('idempotency', s.idempotency), s.id)
end
count('created')
count('upload_bytes', s.input_bytes)
if #result > 0 then
  conclude(s.id, 'succeeded', '',
    {'result', name, 'progress', '1', 'cached', '1', unpack(result)})
  hold_result(name, s.id, time + s.retention_ms)
  count('cache_hits')
  return {'cached', s.id}
end
redis.call('PERSIST', key('blob', 'upload:' .. s.id))
redis.call('ZADD', key('expiry'), text(time + s.retention_ms), s.id)
redis.call('ZADD', key('waiting'), text(time), s.id)
redis.call('SADD', key('active', s.owner), s.id)
touch(s.id)
return {'created', s.id}
