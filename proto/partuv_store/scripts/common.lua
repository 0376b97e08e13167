-- Shared by every script of the store; Python puts it in front of each.
-- KEYS[1] is the key prefix. All times are milliseconds of the Redis clock, so that no two
-- machines ever have to agree on the hour.
local prefix = KEYS[1]
local UNSWEPT_MS = 3600 * 1000 -- keys outlive their retention this long if nobody sweeps

local function key(...)
  return prefix .. table.concat({...}, ':')
end

local function text(number)
  return string.format('%.0f', number)
end

local function now()
  local time = redis.call('TIME')
  return tonumber(time[1]) * 1000 + math.floor(tonumber(time[2]) / 1000)
end

local function count(field, amount)
  redis.call('HINCRBYFLOAT', key('metrics'), field, amount or 1)
end

-- The buckets of every duration histogram; `partuv_store.metrics` lists the same.
local SECONDS = {0.1, 0.25, 0.5, 1, 2.5, 5, 10, 30, 60, 120, 300, 600}

local function observe_seconds(name, seconds)
  count(name .. ':sum', seconds)
  count(name .. ':count')
  for _, bound in ipairs(SECONDS) do
    if seconds <= bound then
      count(name .. ':le:' .. bound)
      return
    end
  end
end

-- A job changed: number the change and wake whoever follows it.
local function touch(id)
  redis.call('HINCRBY', key('job', id), 'revision', 1)
  redis.call('PUBLISH', key('events'), id)
end

-- Blobs are hashes of numbered chunks; the ledger knows what each one weighs.
local function stored_bytes()
  return tonumber(redis.call('GET', key('bytes')) or '0')
end

local function weigh(blob, delta)
  redis.call('HINCRBY', key('ledger'), blob, delta)
  redis.call('INCRBY', key('bytes'), delta)
end

local function drop_blob(blob)
  local size = redis.call('HGET', key('ledger'), blob)
  if size then
    redis.call('HDEL', key('ledger'), blob)
    if redis.call('DECRBY', key('bytes'), size) <= 0 then redis.call('DEL', key('bytes')) end
  end
  redis.call('UNLINK', key('blob', blob))
end

local function move_blob(from, to)
  local size = redis.call('HGET', key('ledger'), from)
  if not size then return false end
  redis.call('RENAME', key('blob', from), key('blob', to))
  redis.call('HDEL', key('ledger'), from)
  redis.call('HSET', key('ledger'), to, size)
  return true
end

local function part_name(id, attempt, kind)
  return 'part:' .. id .. ':' .. attempt .. ':' .. kind
end

local KINDS = {'glb', 'png', 'svg', 'parts'}

local function drop_parts(id, attempt)
  for _, kind in ipairs(KINDS) do drop_blob(part_name(id, attempt, kind)) end
end

-- Same owner, input, options and build: same result.
local function result_name(cache_key, build)
  return cache_key .. '.' .. build
end

-- A result is shared by all jobs with the same cache key and goes with the last of them.
local function hold_result(result, id, expires_at)
  local limit = expires_at + UNSWEPT_MS
  redis.call('SADD', key('refs', result), id)
  local names = {key('result', result), key('refs', result)}
  for _, kind in ipairs(KINDS) do names[#names + 1] = key('blob', 'result:' .. result .. ':' .. kind) end
  for _, name in ipairs(names) do
    local left = redis.call('PTTL', name)
    if left == -1 or (left >= 0 and now() + left < limit) then
      redis.call('PEXPIREAT', name, text(limit))
    end
  end
end

local function drop_result(result, id)
  redis.call('SREM', key('refs', result), id)
  if redis.call('EXISTS', key('refs', result)) == 1 then return end
  for _, kind in ipairs(KINDS) do drop_blob('result:' .. result .. ':' .. kind) end
  redis.call('DEL', key('result', result))
end

-- Out of every line a job may stand in.
local function leave_lines(id, owner)
  redis.call('ZREM', key('waiting'), id)
  redis.call('ZREM', key('running'), id)
  redis.call('SREM', key('active', owner), id)
end

-- The one way a job ends. fields: extra fields of the record.
local function conclude(id, status, code, fields)
  local job = key('job', id)
  local owner, retention, webhook, idempotency, created = unpack(redis.call(
    'HMGET', job, 'owner', 'retention_ms', 'webhook_url', 'idempotency', 'created_at'))
  local time = now()
  local expires_at = time + tonumber(retention)
  leave_lines(id, owner)
  drop_blob('upload:' .. id)
  redis.call('HSET', job, 'status', status, 'finished_at', text(time),
    'expires_at', text(expires_at), unpack(fields))
  redis.call('HDEL', job, 'worker', 'cancel_requested')
  redis.call('PEXPIREAT', job, text(expires_at + UNSWEPT_MS))
  if idempotency ~= '' then
    redis.call('PEXPIREAT', key('idempotency', idempotency), text(expires_at + UNSWEPT_MS))
  end
  redis.call('ZADD', key('expiry'), text(expires_at), id)
  if webhook ~= '' then redis.call('ZADD', key('webhooks'), text(time), id) end
  count('finished:' .. status .. ':' .. code)
  observe_seconds('total_seconds', (time - tonumber(created)) / 1000)
  touch(id)
end

-- Everything of a job disappears.
local function forget(id)
  local job = key('job', id)
  local owner, attempt, result, idempotency =
    unpack(redis.call('HMGET', job, 'owner', 'attempt', 'result', 'idempotency'))
  if not owner then return false end
  leave_lines(id, owner)
  drop_blob('upload:' .. id)
  drop_parts(id, attempt)
  if result and result ~= '' then drop_result(result, id) end
  if idempotency ~= '' then redis.call('DEL', key('idempotency', idempotency)) end
  redis.call('ZREM', key('expiry'), id)
  redis.call('ZREM', key('webhooks'), id)
  redis.call('DEL', job)
  redis.call('PUBLISH', key('events'), id)
  return true
end

-- Back into the line, at the place its age gives it; published_at 0 asks for a new message.
local function requeue(id)
  local job = key('job', id)
  redis.call('HSET', job, 'status', 'queued', 'published_at', '0')
  redis.call('HDEL', job, 'worker')
  redis.call('ZREM', key('running'), id)
  redis.call('ZADD', key('waiting'), redis.call('HGET', job, 'created_at'), id)
  touch(id)
end

-- A worker went away in the middle of a job.
local function lose(id, max_losses, error)
  local job = key('job', id)
  drop_parts(id, redis.call('HGET', job, 'attempt'))
  if redis.call('HGET', job, 'cancel_requested') then
    conclude(id, 'canceled', '', {})
  elseif redis.call('HINCRBY', job, 'losses', 1) >= max_losses then
    conclude(id, 'failed', 'worker_lost', {'error', error})
  else
    requeue(id)
  end
end

-- Does this attempt still own the job?
local function owns(id, attempt)
  local status, current = unpack(redis.call('HMGET', key('job', id), 'status', 'attempt'))
  return status == 'running' and current == attempt
end
